"""The bodies, frames and sites that a recipe adds, to which its parts can be attached."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.document.node import Mapping as Located
from composer.document.node import locate
from composer.plan.steps.add_element import AddElement
from composer.plan.steps.step import Step
from composer.recipe.element import Element
from composer.recipe.fragment import names_in

KINDS = ("body", "frame", "site")


@dataclass(frozen=True, slots=True)
class AddedPlace:
    """A place and the step that adds it; `span` is where its name is written."""

    step: AddElement
    span: Span


def added_places(steps: Sequence[Step], document: Located) -> dict[tuple[str, str], AddedPlace]:
    """Return every place that the steps add, by kind and name; for duplicate names, the first one."""
    found: dict[tuple[str, str], AddedPlace] = {}
    for step in steps:
        if isinstance(step, AddElement):
            for kind, name, span in _places(step.element, document):
                found.setdefault((kind, name), AddedPlace(step, span))
    return found


def makers(
    places: Mapping[tuple[str, str], AddedPlace], kind: str, name: str, done: Container[int] = ()
) -> list[AddElement]:
    """Return the steps that create a place, in the order in which they must run; none if no step does.

    A place on an added element needs the step that adds this element first. `done` has the ids of steps that have run.
    """
    found: dict[int, AddElement] = {}
    while (place := places.get((kind, name))) is not None and id(place.step) not in found:
        if id(place.step) in done:
            break
        found[id(place.step)] = place.step
        kind, name = place.step.to_kind, place.step.to
    return [*reversed(found.values())]


def _places(element: Element, document: Located) -> Iterator[tuple[str, str, Span]]:
    if element.xml is not None:
        span = locate(document, (*element.at, "xml"))
        yield from ((tag, name, span) for tag, name in names_in(element.xml, KINDS))
        return
    name = element.attributes.get("name")
    if name is not None and element.tag in KINDS:
        yield element.tag, str(name), locate(document, (*element.at, "name"))
    for child in element.children:
        yield from _places(child, document)
