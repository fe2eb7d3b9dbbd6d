"""The form of the verb `set`: give attributes new values, or remove them."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.language.assign import Changed, Values, changes_of, flat
from mjcompose.language.edit import Verb
from mjcompose.language.forms.model import WHOLE


class Set(Verb):
    """attributes and their new values; `friction[0]` is one number, null removes an attribute"""

    values: ClassVar = "settable"

    written: Annotated[dict[str, Any], Values("set")] = Field(alias=WHOLE)
    """attributes and their new values"""

    def words(self) -> str:
        return f"set {', '.join(f'{attribute} = {each}' for attribute, each in flat(self.written))}"

    def changes(self, tag: str | None) -> Changed:
        return changes_of(tag, self.written)


VERB = Set
