"""Verb `move`: move elements to another body or frame."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, ClassVar

from pydantic import Discriminator, Field, Tag

from mjcompose.base.diagnostic import Fault
from mjcompose.language.form import Settings
from mjcompose.language.forms.adapters import verb
from mjcompose.language.forms.attribute import Attribute
from mjcompose.language.forms.model import Model
from mjcompose.language.forms.rules import Exclusive
from mjcompose.language.forms.scalars import Name
from mjcompose.language.placing import ORIENTATIONS
from mjcompose.language.select import kinds_of, unknown_attribute
from mjcompose.language.verb import For, Verb, listed
from mjcompose.model.grammar import GRAMMAR

_IN_THE_TREE = {
    child.path for top in ("body", "worldbody") for child in GRAMMAR.element(top).children.values()
}


class Frame(Model):
    """A frame by its name."""

    frame: Annotated[str, Name("frame", computed=True)] = Field(examples=["NAME"])
    """the name of a frame"""


Place = Annotated[
    Annotated[str, Name("body", computed=True, what="a body, `world`, or `{frame: NAME}`"), Tag("<name>")]
    | Annotated[Frame, Tag("<mapping>")],
    Discriminator(lambda value: "<mapping>" if isinstance(value, dict | Frame) else "<name>"),
]


class Move(Verb):
    """Another body or frame to stand in, and the pose there."""

    rules: ClassVar = (
        For(*_IN_THE_TREE, what="for the body tree, and `{tag}` is not in it"),
        Exclusive(*ORIENTATIONS),
    )
    example: ClassVar = "{to: NAME}"
    reshapes: ClassVar = True

    to: Place = Field(examples=["NAME"])
    """a body, `world`, or `{frame: NAME}`"""
    pos: Annotated[Any, Attribute("frame", "pos", computed=True)] = None
    """`pos` in what it then stands in"""
    quat: Annotated[Any, Attribute("frame", "quat", computed=True)] = None
    """`quat` in what it then stands in"""
    euler: Annotated[Any, Attribute("frame", "euler", computed=True)] = None
    """`euler` in what it then stands in"""
    axisangle: Annotated[Any, Attribute("frame", "axisangle", computed=True)] = None
    """`axisangle` in what it then stands in"""
    xyaxes: Annotated[Any, Attribute("frame", "xyaxes", computed=True)] = None
    """`xyaxes` in what it then stands in"""
    zaxis: Annotated[Any, Attribute("frame", "zaxis", computed=True)] = None
    """`zaxis` in what it then stands in"""

    @property
    def pose(self) -> dict[str, Any]:
        """The attributes that are written, in the order of the fields."""
        given = {name: getattr(self, name) for name in ("pos", *ORIENTATIONS)}
        return {name: value for name, value in given.items() if value is not None}

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        tag = context.selected.tag if context.selected is not None else ""
        kinds = kinds_of(tag) if tag else ()
        for name in self.pose if kinds else ():
            if not any(name in kind.attributes for kind in kinds):
                yield unknown_attribute(name, tag, kinds, at=(name,))

    def words(self) -> str:
        place = f"the frame {self.to.frame}" if isinstance(self.to, Frame) else self.to
        return f"move to {place}{listed(self.pose)}"


VERB = verb("move", Move)
