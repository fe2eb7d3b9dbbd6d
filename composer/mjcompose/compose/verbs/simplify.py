"""Verb `simplify`: give meshes fewer faces."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import BeforeValidator, Field

from mjcompose.base.diagnostic import Path
from mjcompose.compose.shapes import simplify_meshes
from mjcompose.compose.verbs.values import Entry
from mjcompose.language.edit import For, Verb
from mjcompose.language.forms.scalars import whole
from mjcompose.plan.plan import in_words


class Simplify(Verb):
    """fewer faces for its mesh"""

    rules: ClassVar = (For("geom", "mesh", what="for meshes and their geoms, and `{tag}` is neither"),)
    example: ClassVar = "{faces: 500}"
    reshapes: ClassVar = True

    faces: Annotated[int, Field(ge=4, le=10**9), BeforeValidator(whole)] = Field(examples=[500])
    """the largest number of faces"""

    def carry_out(self, entry: Entry, at: Path) -> None:
        # All values that the entry writes are checked before.
        entry.check()
        entry.records += simplify_meshes(entry.editing, entry.workshop, entry.found, faces=self.faces, at=at)

    def words(self) -> str:
        return in_words("simplify", {"faces": self.faces})


VERB = Simplify
