"""The form of the verb `remove`: remove elements, alone or with everything that refers to them."""

from __future__ import annotations

from typing import ClassVar, Literal

from pydantic import Field

from mjcompose.language.edit import Verb
from mjcompose.language.forms.model import WHOLE


class Remove(Verb):
    """`true` removes it if nothing refers to it, `cascade` also removes everything that does"""

    alone: ClassVar = True
    reshapes: ClassVar = True

    how: Literal[True, "cascade"] = Field(alias=WHOLE)
    """`true` or `cascade`"""

    def words(self) -> str:
        return "remove" if self.how is True else "remove it, with everything that refers to it"


VERB = Remove
