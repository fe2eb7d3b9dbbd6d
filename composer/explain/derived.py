"""Attributes that `edit`, `randomize` and `check` know and MJCF writes elsewhere, and what determines them.

The mass of a body is that of its `<inertial>` or of its geoms; the `gainprm` of a `<position>` comes from its `kp`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from composer.compiled.attributes import attributes as compared
from composer.grammar import GRAMMAR, ElementType
from composer.link import numbers
from composer.link.inertia import has_mass
from composer.recipe.verbs.values import MASS
from composer.tree.classes import Classes, childclass_of, own
from composer.tree.kinds import kind_of
from composer.tree.settings import read_settings

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_INERTIA = "diaginertia"


def is_derived(node: Node, name: str) -> bool:
    """Return whether recipes have this attribute for the element and MJCF does not write it there."""
    return name in derived_names(kind_of(node))


def derived_names(kind: ElementType) -> tuple[str, ...]:
    """Return the attributes that `edit`, `randomize` and `check: equal` accept beyond those in the grammar."""
    if kind.path == "body":
        return (MASS, _INERTIA)
    if kind.family != "actuator":
        return ()
    return tuple(name for name in compared(kind.family) if name not in kind.attributes)


def givers(node: Node, name: str, classes: Classes) -> list[tuple[Node, str]]:
    """Return the elements and attributes in effect that determine it."""
    if node.tag == "body":
        return list(_of_body(node, name, classes))
    general = GRAMMAR.element("actuator/motor").attributes
    return [(node, each) for each in kind_of(node).attributes if each not in general]


def total(found: list[tuple[Node, str]], name: str, values: list[str | None]) -> str | None:
    """Return the value if the elements write it, or None if MuJoCo computes it."""
    if not found and name == MASS:
        return "0"
    if len(found) == 1 and found[0][1] == name and found[0][0].tag == "inertial":
        return values[0]
    if name != MASS or any(attribute != MASS for _, attribute in found):
        return None
    return numbers.text([sum(numbers.read(str(value))[0] for value in values)])


def _of_body(body: Node, name: str, classes: Classes) -> Iterator[tuple[Node, str]]:
    root = body.getroottree().getroot()
    rule = read_settings(root).inertiafromgeom
    geoms = [geom for geom in own(body, "geom") if has_mass(geom, classes)]
    inertials = own(body, "inertial")
    if inertials and not (rule == "true" and geoms):
        written = next((each for each in (name, "fullinertia") if inertials[-1].get(each)), name)
        yield inertials[-1], MASS if name == MASS else written
        return
    for geom in geoms if rule != "false" else ():
        mass = classes.effective(geom, childclass_of(geom), MASS)
        yield geom, "density" if mass is None else MASS
