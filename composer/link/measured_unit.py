"""A unit compiled alone by MuJoCo, with the rows of its bodies and geoms in the arrays of `mjModel`."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.link.linking import Linking
from composer.tree.classes import walk_bodies
from composer.tree.scaled import first_scaled
from composer.tree.unit import Unit

BODIES = ("body_mass", "body_ipos", "body_iquat", "body_inertia")
GEOMS = ("geom_size", "geom_pos", "geom_quat")
_NAMES = {"mesh": "name_meshadr", "material": "name_matadr", "texture": "name_texadr"}
NAMED = ("names", *_NAMES.values())
_SURVEYED = ("body", "geom")
_MARKS = ("body_user", "geom_user", "body_mass", "geom_type")
# What MuJoCo makes bodies or geoms of that are elements of no unit.
_OPAQUE = ("attach", "composite")


@dataclass(frozen=True, slots=True)
class Survey:
    """The result of compiling a unit alone.

    `arrays` are MuJoCo's arrays; `rows` has, for each body and geom, the rows of its copies: none if MuJoCo left it
    out.
    """

    arrays: Mapping[str, list[float]]
    rows: Mapping[Node, tuple[int, ...]]

    def is_gone(self, element: Node) -> bool:
        return not self.rows[element]

    def values(self, element: Node, array: str, width: int) -> list[float] | None:
        """Return the values of an array for an element, or None if its copies differ."""
        numbers = self.arrays[array]
        found = [numbers[width * row : width * (row + 1)] for row in self.rows[element]]
        return found[0] if found and all(each == found[0] for each in found) else None

    def names(self, tag: str) -> set[str]:
        """Return the names of the remaining meshes, materials or textures."""
        text = bytes(int(character) for character in self.arrays["names"])
        starts = [int(start) for start in self.arrays[_NAMES[tag]]]
        return {text[start : text.index(b"\0", start)].decode("utf-8", "replace") for start in starts}


@dataclass(frozen=True, slots=True)
class Unmeasurable:
    """The reason why a unit cannot be measured, and the element that causes it, if there is one."""

    why: str
    element: Node | None = None


def survey(
    linking: Linking,
    unit: Unit,
    settings: Sequence[str],
    arrays: tuple[str, ...],
    *,
    pinned: Collection[Node] = (),
) -> Survey | None:
    """Measure the unit to keep the effect of these settings. Report an error if that is not possible."""
    found = measured(linking, unit, arrays, pinned=pinned)
    if isinstance(found, Unmeasurable):
        cannot_be_kept(linking, unit, settings, found.why, found.element)
        return None
    return found


def measured(
    linking: Linking, unit: Unit, arrays: tuple[str, ...], *, pinned: Collection[Node] = ()
) -> Survey | Unmeasurable | None:
    """Compile the unit alone, without the alignment of free bodies, which is done in the model.

    None where MuJoCo refuses the unit, which has been reported. `pinned` bodies are kept from being fused: something
    refers to them.
    """
    opaque = next(unit.root.iter(*_OPAQUE), None)
    why = None
    if opaque is not None:
        why = f"`<{opaque.tag}>` is expanded by MuJoCo"
    elif first_scaled(unit.root) is not None:
        why = "MuJoCo scales what is in a `<frame>`"
    elif linking.measure is None:
        why = "MuJoCo is not at hand"
    if why is not None or linking.measure is None:
        return Unmeasurable(str(why))
    # `user` finds an element again in the arrays: MuJoCo carries it over to every copy. Names may be missing, and
    # numbers change when bodies are fused or geoms discarded.
    copy = unit.copied()
    marked: list[Node] = []
    for (original, _), (element, _) in zip(walk_bodies(unit.root), walk_bodies(copy.root), strict=True):
        if original.tag in _SURVEYED:
            marked.append(original)
            element.set("user", str(len(marked)))
        if original in pinned:
            _pin(copy, element, len(marked))
    _neutral(copy.root)
    found = linking.measure(copy, tuple(dict.fromkeys((*arrays, *_MARKS))))
    if not found:
        return None
    rows: dict[Node, list[int]] = {element: [] for element in marked}
    for marks, counted in (("body_user", "body_mass"), ("geom_user", "geom_type")):
        for row, mark in _first(found[marks], len(found[counted])):
            rows[marked[mark - 1]].append(row)
    for element, places in rows.items():
        if places and len(places) != _copies(element):
            return Unmeasurable(f"it leaves out some copies of `<{element.tag}>` only", element)
    return Survey(found, {element: tuple(places) for element, places in rows.items()})


def cannot_be_kept(
    linking: Linking, unit: Unit, settings: Sequence[str], why: str, element: Node | None = None
) -> None:
    """Report that settings cannot be kept, at an element or where the first of them is written."""
    first, named = settings[0], " and ".join(f"`{name}`" for name in settings)
    compilers = list(unit.root.iterchildren("compiler"))
    compiler = next((each for each in compilers if each.get(first) is not None), [*compilers, unit.root][0])
    linking.sink.error(
        "compiler-setting",
        f"{named} of `{unit.label}` cannot be kept in a composition: {why}",
        linking.span(unit, compiler, first) if element is None else linking.span(unit, element),
        help="remove the setting from the source, or write the values it gives",
    )


def _pin(unit: Unit, body: Node, number: int) -> None:
    """Add a sensor of a body, which keeps the body from being fused in every version of MuJoCo."""
    # Under `fusestatic` MuJoCo 4.0 fuses a body without joints, but not one that a `framepos` names.
    if not body.get("name"):
        body.set("name", f"pinned body {number} of {len(unit.root)}")
    sensors = unit.section("sensor")
    sensors.append(sensors.makeelement("framepos", {"objtype": "body", "objname": str(body.get("name"))}))


def _neutral(root: Node) -> None:
    """Prevent the alignment of free bodies, so that the inertia is in the frame in which it will be written."""
    for joint in root.iter("freejoint"):
        joint.set("align", "false")
    for tag, names in (("compiler", ("alignfree",)), ("size", ("nuser_body", "nuser_geom"))):
        for element in root.iterchildren(tag):
            for name in names:
                if name in element.attrib:
                    del element.attrib[name]


def _first(marks: list[float], count: int) -> Iterator[tuple[int, int]]:
    """Yield the mark of each row that has one."""
    width = len(marks) // count if count else 0
    for row in range(count if width else 0):
        if mark := int(marks[row * width]):
            yield row, mark


def _copies(element: Node) -> int:
    count = 1
    for replicate in element.iterancestors("replicate"):
        count *= int(str(replicate.get("count") or 1))
    return count
