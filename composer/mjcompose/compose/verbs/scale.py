"""Verb `scale`: multiply numbers."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Path
from mjcompose.compose.verbs.values import SCALE, Entry, change_all, report_only_zeros, zero_attributes
from mjcompose.language.assign import Changed, Values, changes_of, flat
from mjcompose.language.edit import Verb
from mjcompose.language.forms.model import WHOLE


class Scale(Verb):
    """attributes and their factors"""

    values: ClassVar = "scalable"

    written: Annotated[dict[str, Any], Values("scale")] = Field(alias=WHOLE)
    """attributes and their factors"""

    def carry_out(self, entry: Entry, at: Path) -> None:
        zeros = zero_attributes(entry.editing, entry.found, self.written)
        change_all(entry, SCALE, self.written, at=at)
        for key in zeros:
            name = f'"{key}"' if "[" in key else key
            help = f"write the value itself: `set: {{{name}: …}}`"
            report_only_zeros(entry.editing, entry.found, key, at=(*at, key), help=help)

    def words(self) -> str:
        return f"scale {', '.join(f'{attribute} × {each}' for attribute, each in flat(self.written))}"

    def changes(self, tag: str | None) -> Changed:
        return changes_of(tag, self.written)


VERB = Scale
