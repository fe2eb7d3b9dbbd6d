"""The form of the verb `move`: move an element to another body or frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from pydantic import Field

from mjcompose.base.diagnostic import Fault
from mjcompose.language.edit import For, Verb, listed
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import Exclusive
from mjcompose.language.forms.scalars import AttributeValue
from mjcompose.language.placing import ORIENTATIONS, Frame, Place
from mjcompose.language.select import kinds_of, unknown_attribute
from mjcompose.tree.grammar import GRAMMAR

_IN_THE_TREE = {child.path for top in ("body", "worldbody") for child in GRAMMAR.element(top).children.values()}


class Move(Verb):
    """The new parent, a body or a frame, and the pose there."""

    rules: ClassVar = (For(*_IN_THE_TREE, what="for the body tree, and `{tag}` is not in it"), Exclusive(*ORIENTATIONS))
    example: ClassVar = "{to: NAME}"
    reshapes: ClassVar = True

    to: Place = Field(examples=["NAME"])
    """a body, `world`, or `{frame: NAME}`"""
    pos: Annotated[Any, AttributeValue("frame", "pos", computed=True)] = None
    """`pos` in the frame of the new parent"""
    quat: Annotated[Any, AttributeValue("frame", "quat", computed=True)] = None
    """`quat` in the frame of the new parent"""
    euler: Annotated[Any, AttributeValue("frame", "euler", computed=True)] = None
    """`euler` in the frame of the new parent"""
    axisangle: Annotated[Any, AttributeValue("frame", "axisangle", computed=True)] = None
    """`axisangle` in the frame of the new parent"""
    xyaxes: Annotated[Any, AttributeValue("frame", "xyaxes", computed=True)] = None
    """`xyaxes` in the frame of the new parent"""
    zaxis: Annotated[Any, AttributeValue("frame", "zaxis", computed=True)] = None
    """`zaxis` in the frame of the new parent"""

    @property
    def pose(self) -> dict[str, Any]:
        """The attributes that are written, in the order of the fields."""
        given = {name: getattr(self, name) for name in ("pos", *ORIENTATIONS)}
        return {name: value for name, value in given.items() if value is not None}

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        tag = context.selected.tag if context.selected is not None else ""
        kinds = kinds_of(tag) if tag else ()
        if kinds:
            for name in self.pose:
                if not any(name in kind.attributes for kind in kinds):
                    yield unknown_attribute(name, tag, kinds, at=(name,))

    def words(self) -> str:
        place = f"the frame {self.to.frame}" if isinstance(self.to, Frame) else self.to
        return f"move to {place}{listed(self.pose)}"


VERB = Move
