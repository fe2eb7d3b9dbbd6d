"""What a recipe writes, as steps in the order in which they are carried out."""

from __future__ import annotations

from collections.abc import Iterator

from composer.document.node import Mapping, locate
from composer.plan.plan import (
    AddElement,
    AppendElement,
    DrawValues,
    EditElements,
    SetDefault,
    SetSingleton,
    Step,
    WriteKeyframe,
)
from composer.recipe.element import Element
from composer.recipe.randomize import Randomize
from composer.recipe.recipe import Recipe

_SINGLETONS = ("compiler", "option", "size", "visual", "statistic")
_SECTIONS = (
    "extension", "asset", "deformable", "contact", "tendon", "equality", "actuator", "sensor", "custom",
)  # fmt: skip


def steps_of(recipe: Recipe, document: Mapping, randomize: Randomize | None, sample: int) -> Iterator[Step]:
    """`add` first, then the sections: settings, classes, and what may use them."""
    for item in recipe.add:
        path = (*item.at, "to", "frame") if item.to_kind == "frame" else (*item.at, "to")
        span = locate(document, item.element.at)
        yield AddElement(item.to_kind, item.to, item.element, locate(document, path), span)
    for section in _SINGLETONS:
        element: Element | None = getattr(recipe, section)
        if element is not None:
            yield SetSingleton(section, element, locate(document, element.at, key=True))
    for each in recipe.default:
        yield SetDefault(each.name, each.parent, each.element, locate(document, each.element.at, key=True))
    for section in _SECTIONS:
        for element in getattr(recipe, section):
            yield AppendElement(section, element, locate(document, element.at, key=True))
    for edit in recipe.edit:
        yield EditElements(edit, locate(document, edit.at))
    for field in randomize.fields if randomize is not None else ():
        if randomize is not None and field.select is not None:
            span = locate(document, field.drawn_at)
            yield DrawValues(
                field, randomize.seed, sample, randomize.samples, span, randomize.emit == "table"
            )
    for key in recipe.keyframe:
        yield WriteKeyframe(key, locate(document, key.at, key=True))


def settled(steps: tuple[Step, ...]) -> Iterator[str]:
    """The paths of the values that the recipe sets itself (`option/cone`)."""

    def walk(element: Element, path: str) -> Iterator[str]:
        yield from (f"{path}/{name}" for name in element.attributes)
        for child in element.children:
            yield from walk(child, f"{path}/{child.tag}")

    for step in steps:
        if isinstance(step, SetSingleton):
            yield from walk(step.element, step.section)
