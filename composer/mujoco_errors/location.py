"""Find where a faulty value is written: on the element that MuJoCo names, in its class, or inside its body."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePath
from typing import TYPE_CHECKING, NamedTuple

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.span import Span
from composer.mujoco_errors.sentence import Topic
from composer.mujoco_errors.translation import Translation, kind_of
from composer.sources.source import FORMATS
from composer.tree.classes import own
from composer.tree.effective import Level, levels
from composer.tree.unit import Unit

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_MASSES = {"inertial": ("mass", "diaginertia", "fullinertia"), "geom": ("mass", "density")}


class FaultLocation(NamedTuple):
    """The place to show, and notes about other places."""

    span: Span
    notes: tuple[Note, ...] = ()


def locate_fault(said: Translation, element: Node, model: Unit) -> FaultLocation:
    """Return the place of a fault; a value from the recipe comes first, because its author can change it."""
    span = model.origins.span(element, model.file, said.attribute, key=said.key)
    if said.attribute is None:
        masses = _masses(element, model) if said.topic is Topic.MASS else ()
        written = next((each for each in masses if _in_recipe(each)), None)
        return (
            FaultLocation(span)
            if written is None
            else FaultLocation(written, (Note("the body stands here", span),))
        )
    level = _class_level(said.attribute, element, model)
    if level is None or level.writer is None:
        return FaultLocation(span)
    there = model.origins.span(level.writer, model.file, said.attribute)
    if _in_recipe(there):
        return FaultLocation(
            there, (Note(f"the default class `{level.name}` gives it to this {element.tag}", span),)
        )
    return FaultLocation(
        span, (Note(f"`{said.attribute}` is that of the default class `{level.name}`", there),)
    )


def _class_level(attribute: str, element: Node, model: Unit) -> Level | None:
    """Return the class that sets an attribute which the element does not write."""
    kind = kind_of(element)
    known = kind.attributes.get(attribute) if kind is not None else None
    if kind is None or known is None or element.get(attribute) is not None:
        return None
    given = (
        level for level in levels(element, kind, known, classes=model.classes) if level.taken or level.text
    )
    nearest = next(given, None)
    return nearest if nearest is not None and nearest.kind == "class" else None


def _masses(element: Node, model: Unit) -> Iterator[Span]:
    """Yield where the masses of a body are written, in its `<inertial>` or else in its geoms."""
    for child in own(element, "inertial") or own(element, "geom"):
        for name in _MASSES[str(child.tag)]:
            if child.get(name) is not None:
                yield model.origins.span(child, model.file, name)


def _in_recipe(span: Span) -> bool:
    return FORMATS.get(PurePath(span.file).suffix.lower()) == "recipe"
