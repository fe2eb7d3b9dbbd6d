"""The path of a tendon: its steps in order. In MJCF they are children with several tags."""

from __future__ import annotations

from typing import Any

from composer.grammar.element import ElementType
from composer.recipe.element import Element
from composer.recipe.fault import EXCLUSIVE, Fault, Path
from composer.recipe.raw import path_of
from composer.recipe.reader import FRAGMENT, Reader
from composer.recipe.shown import kind_of
from composer.recipe.value import read_value

PATH = "path"
# By tag, the key that decides which element a step is, and the attribute that the key gives.
MARKS: dict[str, str] = {"site": "site", "geom": "geom", "pulley": "divisor", "joint": "joint"}


def read_path(reader: Reader, kind: ElementType, value: Any, at: Path, owner: str) -> tuple[Element, ...]:
    """Return the steps of a tendon.

    They are written as `[{site: a}, {geom: g, sidesite: s}, {pulley: 2}, {site: b}]`, or for a fixed tendon as
    `[{joint: j, coef: 1}]`. `{divisor: 2}` is a pulley too.
    """
    if not isinstance(value, list):
        message = f"`{PATH}` of {owner} expects a list of steps, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=f"write `{PATH}: [{_example(kind)}, …]`"))
        return ()
    if not value:
        reader.faults.append(Fault("wrong-length", f"`{PATH}` of {owner} has no steps", at))
    steps = [_step(reader, kind, item, at=(*at, index), owner=owner) for index, item in enumerate(value)]
    return tuple(step for step in steps if step is not None)


def _step(reader: Reader, kind: ElementType, value: Any, at: Path, owner: str) -> Element | None:
    place = f"the `{PATH}` of {owner}"
    if not isinstance(value, dict):
        message = f"a step in {place} is a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help=f"write for instance `{_example(kind)}`"))
        return None
    if FRAGMENT in value:
        return reader.fragment(kind.children, place, value, at=at)
    if "geom" in value and "site" in value:
        message = f"a step in {place} has both `geom` and `site`, of which only one may stand"
        help = "write `sidesite` for a site at the side of the geom, or a step of its own for the site"
        reader.faults.append(Fault(EXCLUSIVE, message, (*at, "site"), key=True, help=help))
        return None
    tag = next((tag for tag in kind.children if tag in value), None)
    if tag is None:
        tag = next((tag for tag in kind.children if MARKS[tag] in value), None)
    if tag is None:
        known = ", ".join(f"`{each}`" for each in kind.children)
        message = f"a step in {place} has none of {known}"
        reader.faults.append(Fault("missing-key", message, at, help=f"write for instance `{_example(kind)}`"))
        return None
    if isinstance(value.get(tag), dict):
        nested = value[tag]
        message = f"`{tag}` of a step in {place} expects a name, got {kind_of(nested)}"
        flat = f"write what the step has beside one another: `{_flat(nested)}`" if nested else None
        reader.faults.append(Fault("wrong-type", message, (*at, tag), help=flat))
        return None
    step = kind.children[tag]
    label = f"the `{tag}` step of {owner}"
    if tag not in value or MARKS[tag] == tag:
        return reader.element(step, value, at, label)
    return _short(reader, step, tag, value=value, at=at, owner=label)


def _short(
    reader: Reader, step: ElementType, tag: str, value: dict[str, Any], at: Path, owner: str
) -> Element | None:
    """Return a step such as `{pulley: 2}`, in which a tag has the value of its only attribute, or None."""
    for name in value:
        if name != tag:
            reader.faults.append(
                reader.unknown(step, name, value[name], at=(*at, name), owner=owner, own=(), taken=value)
            )
    read = read_value(step.attributes[MARKS[tag]], value[tag], (*at, tag), owner=owner, faults=reader.faults)
    return None if read is None else Element(tag, {MARKS[tag]: read}, at=path_of(value))


def _flat(step: dict[str, Any]) -> str:
    return "{" + ", ".join(f"{name}: {value}" for name, value in step.items()) + "}"


def _example(kind: ElementType) -> str:
    return "{site: NAME}" if "site" in kind.children else "{joint: NAME, coef: 1}"
