"""The form of the verb `simplify`: give meshes fewer faces."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import BeforeValidator, Field

from mjcompose.language.edit import For, Verb, with_settings
from mjcompose.language.forms.scalars import whole


class Simplify(Verb):
    """fewer faces for its mesh"""

    rules: ClassVar = (For("geom", "mesh", what="for meshes and their geoms, and `{tag}` is neither"),)
    example: ClassVar = "{faces: 500}"
    reshapes: ClassVar = True

    faces: Annotated[int, Field(ge=4, le=10**9), BeforeValidator(whole)] = Field(examples=[500])
    """the largest number of faces"""

    def words(self) -> str:
        return with_settings("simplify", {"faces": self.faces})


VERB = Simplify
