"""The elements of a model by kind and name, and the pairs of them with the same meaning.

A merged model may write the same thing differently: in radians, with six digits, with `pos` and `quat` for
`fromto`, with a class instead of an attribute. Comparing compiled models limits edits to differences in meaning.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from functools import partial
from itertools import count
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import Struct
from mjcompose.base.rotation import Pose, quat_from_zaxis
from mjcompose.contrast.changes import FieldChange, Value
from mjcompose.contrast.models import DifferingValues, references
from mjcompose.link.numbers import read, read_pose
from mjcompose.mujoco.arrays import about
from mjcompose.mujoco.attributes import KINDS, NameTable
from mjcompose.mujoco.match import Correspondence, Mount
from mjcompose.mujoco.unequal import Bound
from mjcompose.text.faults import word
from mjcompose.tools.importing.search import Instance
from mjcompose.trace.query import kinds_in_order
from mjcompose.tree.classes import childclass_of
from mjcompose.tree.files import SourceSettings
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType, to_text
from mjcompose.tree.unit import Unit

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


def flow(values: dict[str, str]) -> str:
    return "{" + ", ".join(f"{word(key)}: {value}" for key, value in values.items()) + "}"


def nested(values: dict[str, object]) -> str:
    return flow({k: nested(v) if isinstance(v, dict) else str(v) for k, v in values.items()})


def numbers(values: tuple[float, ...]) -> str:
    """Return numbers with twelve digits if only rounding errors follow, and with all digits otherwise.

    >>> numbers((0.1 + 0.2, 1e-17, 0.943714364147489))
    '[0.3, 0, 0.943714364147489]'
    """
    pairs = ((f"{round(value, 12) + 0.0:.12g}", value) for value in values)
    close = partial(math.isclose, rel_tol=1e-15, abs_tol=1e-15)
    return f"[{', '.join(short if close(float(short), value) else repr(value) for short, value in pairs)}]"


SECTIONS = ("worldbody", "tendon", "equality", "actuator", "sensor", "contact")


class ModelElement(Struct):
    """An element with or without a name; `namespace` is where its name must be unique."""

    node: Node
    kind: ElementType
    section: str
    namespace: str

    @property
    def name(self) -> str:
        return str(self.node.get("name") or "")


def items(unit: Unit) -> Iterator[ModelElement]:
    """Yield the elements of the body tree and of the sections in their order, without the steps of tendons."""
    for section in unit.root.iterchildren(*SECTIONS):
        kinds = GRAMMAR.within(str(section.tag))
        nodes = section.iter("*") if section.tag == "worldbody" else section.iterchildren("*")
        for node in nodes:
            kind = kinds.get(str(node.tag))
            name = None if kind is None else kind.attributes.get("name")
            if node is not section and kind is not None and name is not None and name.declares is not None:
                yield ModelElement(node, kind, str(section.tag), namespace=name.declares)


def named(unit: Unit) -> dict[tuple[str, str], ModelElement]:
    return {(each.namespace, each.name): each for each in items(unit) if each.name}


def effective(item: ModelElement, unit: Unit) -> dict[str, str]:
    """Return the values that an element writes or gets from its class, without names and classes."""
    around = childclass_of(item.node)
    names = (name for name in item.kind.attributes if name not in ("name", "class", "childclass"))
    values = {name: unit.classes.effective(item.node, around, name) for name in names}
    return {name: " ".join(value.split()) for name, value in values.items() if value is not None}


def differing(one: dict[str, str], other: dict[str, str], kind: ElementType, prefix: str) -> dict[str, str | None]:
    """Return the values of `other` that `one` lacks, with None for values that only `one` has.

    A name in `one` equals the same name with `prefix` before it in `other`.
    """
    changes: dict[str, str | None] = {}
    for name, attribute in kind.attributes.items():
        before, after = (each.get(name) or default_text(attribute) for each in (one, other))
        if before != after and not (before and after and _same(before, after, attribute, prefix=prefix)):
            changes[name] = after
    return changes


def default_text(attribute: Attribute) -> str | None:
    """Return MuJoCo's default, if the grammar knows it."""
    return None if attribute.default in (None, ()) else to_text(attribute, attribute.default)


def _same(before: str, after: str, attribute: Attribute, prefix: str) -> bool:
    if attribute.is_number:
        try:
            a, b = ([float(each) for each in text.split()] for text in (before, after))
        except ValueError:
            return False
        default = [float(each) for each in (default_text(attribute) or "").split()]
        length = max(len(a), len(b))
        ours, theirs = ([*each, *default[len(each) : length]] for each in (a, b))
        return len(ours) == len(theirs) and all(map(is_rounded, ours, theirs))
    if attribute.is_reference:
        return [prefix + each for each in before.split()] == after.split()
    return attribute.type in ("file", "name")


def assets_of(unit: Unit) -> dict[tuple[str, str], Node]:
    """Return the assets by tag and name; an unnamed asset has the stem of its file as name."""
    nodes = (node for section in unit.root.iterchildren("asset") for node in section.iterchildren("*"))
    return {
        (str(node.tag), str(node.get("name") or PurePosixPath(node.get("file") or "").stem)): node for node in nodes
    }


def settings_of(unit: Unit) -> dict[tuple[str, ...], str]:
    found: dict[tuple[str, ...], str] = {}

    def walk(node: Node, path: tuple[str, ...]) -> None:
        found.update({(*path, str(name)): " ".join(str(value).split()) for name, value in node.attrib.items()})
        for child in node.iterchildren("*"):
            walk(child, (*path, str(child.tag)))

    for section in unit.root.iterchildren("option", "size", "visual", "statistic"):
        walk(section, (str(section.tag),))
    return found


# Ranks. Classes come first. Removals come after all changes, because they may select by number, and references are
# removed before their targets. Renames come last: until then, names are the parts' own.
CLASSES = -1
REMOVED = 10_000
RENAMED = 20_000


class SectionEntry(Struct, frozen=False):
    """One entry of a section of the recipe; `note` is the reason if it is only a comment.

    Entries are in groups within a section, ordered by `rank`: removals by number come last.
    """

    section: str
    text: str
    note: str | None = None
    group: str = ""
    rank: int = 0


class Pair(Struct):
    """An element of a part and its differences in the merged model; `select` is its selector in the recipe."""

    select: str
    item: ModelElement
    each: Instance
    changes: dict[str, str | None]
    moved: dict[str, str]


class ChangedAttribute(Struct):
    """An attribute whose value differs between the merged model and the parts.

    `kind` and `name` describe the element, or the class if `count` elements get the value from it. `before`
    and `after` are the written values, None if there is none.
    """

    kind: str
    name: str
    attribute: str
    before: str | None
    after: str | None
    unit: str = ""
    count: int = 1


Names = dict[str, dict[str, str]]
"""By kind, the names of a part's elements in the merged model that are not just prefixed."""


def selector_of(namespace: str, tag: str, name: str) -> str:
    kind = namespace if namespace in ("actuator", "sensor", "equality", "tendon") else tag
    return f"{{{kind}: {word(name)}}}"


def written_value(attribute: Attribute, text: str) -> str:
    if attribute.separated and attribute.max_length != 1:
        return f"[{', '.join(map(word, text.split()))}]"
    return text if attribute.type == "bool" or attribute.is_number else word(text)


POSE = frozenset({"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "fromto"})


def plain(values: Mapping[str, str], tag: str, settings: SourceSettings, degrees: bool) -> dict[str, str]:
    """Return the values with joint angles in the given unit."""
    found = dict(values)
    if tag != "joint" or found.get("type") == "slide" or (settings.angle == "degree") == degrees:
        return found
    factor = 180 / math.pi if degrees else math.pi / 180
    for name in ("range", "ref", "springref", "springyield"):
        if name in found:
            found[name] = " ".join(f"{number * factor:.12g}" for number in read(found[name]))
    return found


def pose_in(values: Mapping[str, str] | Node, settings: SourceSettings) -> Pose:
    """Return the pose that attributes describe under the compiler settings of their model."""
    return read_pose(values, settings.angle == "degree", settings.eulerseq)


Placed = tuple[Pose, list[float]]


def placed(values: Mapping[str, str], settings: SourceSettings) -> Placed | None:
    """Return the pose and size that the values describe, or None if they are not numbers."""
    try:
        pose = pose_in(values, settings)
        size = read(values.get("size", ""))
        if not values.get("fromto"):
            return pose, size
        ends = read(values["fromto"])
        middle = [(a + b) / 2 for a, b in zip(ends[:3], ends[3:], strict=True)]
        axis = [a - b for a, b in zip(ends[:3], ends[3:], strict=True)]
        half = math.dist(ends[:3], ends[3:]) / 2
        boxed = values.get("type") in ("box", "ellipsoid")
        size = [size[0], size[0], half] if boxed else [size[0], half]
        return Pose((middle[0], middle[1], middle[2]), quat_from_zaxis(axis)), size
    except (ValueError, IndexError):
        return None


def at_the_same_place(here: Placed | None, there: Placed | None) -> bool:
    """Return whether two poses and sizes, as `placed` returns them, are the same except for rounding."""
    if here is None or there is None or len(here[1]) != len(there[1]):
        return False
    is_turned_alike = is_near(here[0].quat, there[0].quat) or is_near(here[0].quat, [-x for x in there[0].quat])
    return is_turned_alike and is_near(here[0].pos, there[0].pos) and is_near(here[1], there[1])


def is_rounded(exact: float, written: float) -> bool:
    """Return whether one number is the other, or the other rounded to the six digits that MuJoCo writes.

    >>> is_rounded(1.5707963267948966, 1.5708), is_rounded(1.5707963267948966, 1.571)
    (True, False)
    """
    return exact == written or float(f"{exact:.6g}") == written


ROUNDING = 1e-5
"""MuJoCo writes six digits when it saves a model: numbers that differ by less are the same."""

_SMALLEST = 1e-6  # smaller numbers are compared as if they had this size
_MASSES = frozenset({"body_mass", "body_inertia", "body_ipos", "body_iquat"})


class Likeness(Struct):
    """By kind, the pairs of elements of the part and the merged model that are the same except for rounding.

    Elements have MuJoCo's numbers; `counts` has the counts in both models, by kind.
    """

    same: Mapping[str, frozenset[tuple[int, int]]] = field(default_factory=dict)
    counts: Mapping[str, tuple[int, int]] = field(default_factory=dict)


def unchanged(mujoco: Any, alone: MjModel, merged: MjModel, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return a `Likeness` as JSON data; runs under `mjcompose.mujoco.engine.call`.

    ``given`` has the ``prefix`` of the part's names in the merged model, ``names`` for names that are not just
    prefixed, and the ``body`` that the part is attached to.
    """
    tables = (NameTable(alone), NameTable(merged))
    mount = Mount(given["body"], None)
    matching = Correspondence(*tables, prefix=given["prefix"], mount=mount, renamed=given["names"], by_order=False)
    changed: dict[str, set[tuple[int, int]]] = defaultdict(set)
    for each in (*references(matching), *DifferingValues(mujoco, matching, 0.0).changes()):
        if not about(each.field).is_computed and not is_rounding(each):
            changed[each.kind].add(each.index)
            if each.field in _MASSES:
                changed["mass"].add(each.index)
    kinds = [kind for kind in KINDS if kind != "key"]
    same = {kind: [pair for pair in matching.pairs(kind) if pair not in changed[kind]] for kind in kinds}
    heavier = {after for _, after in changed["mass"]}  # its own numbers do not say which geom causes that
    same["geom"] = [pair for pair in same["geom"] if int(merged.geom_bodyid[pair[1]]) not in heavier]
    counts = {kind: [len(getattr(model, KINDS[kind].addresses)) for model in (alone, merged)] for kind in KINDS}
    return {"same": same, "counts": counts}


def likeness_of(data: Mapping[str, Any]) -> Likeness:
    same = {kind: frozenset((i, j) for i, j in pairs) for kind, pairs in data["same"].items()}
    return Likeness(same, {kind: (a, b) for kind, (a, b) in data["counts"].items()})


def is_rounding(change: FieldChange) -> bool:
    """Return whether the numbers are the same to six digits; quaternions may have the opposite sign."""
    ours = numbers_likeness(change.before)
    theirs = numbers_likeness(change.after)
    if ours is None or theirs is None or len(ours) != len(theirs):
        return False
    return is_near(ours, theirs) or (change.field.endswith("quat") and is_near(ours, [-each for each in theirs]))


def is_near(ours: Sequence[float], theirs: Sequence[float]) -> bool:
    size = max([_SMALLEST, *map(abs, ours), *map(abs, theirs)])
    bound = Bound(ROUNDING, floor=size)
    return all(map(bound.allows, ours, theirs))


def numbers_likeness(value: Value) -> list[float] | None:
    """Return the numbers of a value as a flat list, or None if it contains anything else."""
    if isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool)):
        return [value]
    inner = [numbers_likeness(each) for each in value] if isinstance(value, tuple) else [None]
    return None if None in inner else [number for each in inner for number in each or ()]


def places(unit: Unit) -> dict[Node, tuple[str, int]]:
    """Return kind and number of every element in MuJoCo's order, unless one element of the file makes several."""
    numbers = defaultdict[str, Iterator[int]](count)
    return {node: (kind, next(numbers[kind])) for kind, node in kinds_in_order(unit.root)}
