"""Settings in the sections that a model has only once, and MuJoCo's rules for merging two values."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, lru_cache, partial
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span
from composer.grammar import GRAMMAR
from composer.link import numbers
from composer.tree.unit import Unit

SINGLETONS = ("option", "visual", "statistic")
_SMALLER_IS_SAFER = (
    "timestep",
    "tolerance",
    "ls_tolerance",
    "noslip_tolerance",
    "ccd_tolerance",
    "sleep_tolerance",
)
_LARGER_IS_SAFER = ("iterations", "ls_iterations", "noslip_iterations", "ccd_iterations", "sdf_iterations",
                    "sdf_initpoints")  # fmt: skip


class Written(NamedTuple):
    """A setting, and a function that finds where it is written.

    `parts` are the parts that it comes from, if the unit is a nested recipe.
    """

    value: str
    span: Callable[[], Span]
    parts: tuple[str, ...] = ()


def written(unit: Unit) -> dict[str, Written]:
    """Return every setting in the unit's own tree by its path. If a section repeats, the last value wins."""
    found: dict[str, Written] = {}
    for section in unit.root.iterchildren(*SINGLETONS):
        _note(section, str(section.tag), unit, found)
    return found


def opinions(unit: Unit) -> dict[str, Written]:
    """Return the settings a unit asks for: its own, and for a nested recipe the defaults that its parts agree on."""
    own = written(unit)
    if not unit.adopted:
        return own
    agreed = {each.path: each for each in unit.adopted}
    found = {
        path: Written(each.value, each.at, each.parts) for path, each in agreed.items()
        if not each.is_written
    }  # fmt: skip
    for path, each in own.items():
        known = agreed.get(path)
        parts = known.parts if known is not None and equal(known.value, each.value) else ()
        found[path] = Written(each.value, each.span, parts)
    return found


def _note(element: Node, path: str, unit: Unit, found: dict[str, Written]) -> None:
    for name, value in element.items():
        if value and not value.isspace():
            found[f"{path}/{name!s}"] = Written(str(value), partial(_span, unit, element, str(name)))
    for child in element.iterchildren("*"):
        _note(child, f"{path}/{child.tag!s}", unit, found)


def _span(unit: Unit, element: Node, name: str) -> Span:
    return unit.origins.span(element, unit.file, name)


@cache
def default_of(path: str) -> str | None:
    """Return MuJoCo's default of a setting, or None if it has none or computes it."""
    element, name = path.rsplit("/", 1)
    attribute = GRAMMAR.element(element).attributes.get(name)
    value = attribute.default if attribute is not None else None
    if value is None:
        return None
    if isinstance(value, bool):
        return "true" if value else "false"
    return " ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def is_default(path: str, value: str) -> bool:
    """Return whether the value is MuJoCo's default of the setting."""
    default = default_of(path)
    return default is not None and equal(default, value)


@lru_cache(4096)
def equal(a: str, b: str) -> bool:
    """Return whether two values of a setting are equal: `1e-2` is `0.01`."""
    if a == b or a.split() == b.split():
        return True
    try:
        return numbers.read(a) == numbers.read(b)
    except ValueError:
        return False


def merged(path: str, have: Written | None, wanted: Written) -> str | None:
    """Return two values merged as MuJoCo does, or None if they conflict.

    A value that is not written gives way. Of steps and tolerances the smaller is used, of iterations the larger.
    """
    # MuJoCo 4.0 takes of a `timestep` of 0.003 and one of 0.004 the smaller one, whoever writes it, and 0.004 where the
    # other model has it not written.
    if have is None:
        return wanted.value
    name = path.rsplit("/", 1)[1]
    if name in _SMALLER_IS_SAFER:
        return min(have.value, wanted.value, key=lambda text: numbers.read(text)[0])
    if name in _LARGER_IS_SAFER:
        return max(have.value, wanted.value, key=lambda text: numbers.read(text)[0])
    return None


def set_value(unit: Unit, path: str, value: str) -> Node:
    """Write a setting into the tree, and return the element that has it."""
    section, *inner, name = path.split("/")
    element = unit.section(section)
    for tag in inner:
        child = next(element.iterchildren(tag), None)
        if child is None:
            child = element.makeelement(tag)
            element.append(child)
        element = child
    element.set(name, value)
    return element
