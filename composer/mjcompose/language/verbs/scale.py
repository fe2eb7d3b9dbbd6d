"""The form of the verb `scale`: multiply numbers."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.language.assign import Changed, Values, changes_of, flat
from mjcompose.language.edit import Verb
from mjcompose.language.forms.model import WHOLE


class Scale(Verb):
    """attributes and their factors"""

    values: ClassVar = "scalable"

    written: Annotated[dict[str, Any], Values("scale")] = Field(alias=WHOLE)
    """attributes and their factors"""

    def words(self) -> str:
        return f"scale {', '.join(f'{attribute} × {each}' for attribute, each in flat(self.written))}"

    def changes(self, tag: str | None) -> Changed:
        return changes_of(tag, self.written)


VERB = Scale
