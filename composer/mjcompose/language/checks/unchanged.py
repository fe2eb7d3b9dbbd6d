"""The form of the check `unchanged`; planning and composing read the attributes that it excepts."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import advised
from mjcompose.language.check import Check
from mjcompose.language.forms.scalars import Checked, Expects, Items, Name, Text
from mjcompose.tree.grammar import GRAMMAR

OF_THE_WHOLE = frozenset("compiler option size statistic visual extension".split())
"""Sections that are not a part's."""
OWN = frozenset({"class", "childclass", "name", "file"})
"""Attributes that a compiled model does not have as such: they cannot be excepted."""


def attributes() -> list[str]:
    """Return every attribute of MJCF that an element of a model can have, sorted."""
    sections = [tag for tag in GRAMMAR.root.children if tag not in OF_THE_WHOLE]
    kinds = [kind for tag in sections for kind in GRAMMAR.within(tag).values()]
    return sorted({name for kind in kinds for name in kind.attributes} - OWN)


def _known(name: str) -> Fault | None:
    known = attributes()
    if name in known:
        return None
    help, fix = advised(name, known)
    return Fault("unknown-attribute", f"MJCF has no attribute `{name}` that could be excepted", help=help, fix=fix)


_Attribute = Annotated[Text, Checked(_known), Expects("an attribute of MJCF")]


class Unchanged(Check):
    """A part is identical to its source compiled alone."""

    word: ClassVar = "unchanged"
    is_in_mujoco: ClassVar = False
    example: ClassVar = "{}"

    part: Annotated[str, Name("part", what="the prefix of a part")] | None = None
    """the prefix of the part, or `base`; by default all parts"""
    excepted: Annotated[tuple[_Attribute, ...], Items(), Expects("a list of attributes", "[gravcomp]")] = Field(
        (), alias="except"
    )
    """MJCF attributes that you change on purpose"""


KIND = Unchanged
