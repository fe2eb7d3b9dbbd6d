"""Compare two compiled models by the names of their elements."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from mjcompose.contrast.changes import AddressMove, Contrast, FieldChange, SizeChange, Value
from mjcompose.mujoco import compare
from mjcompose.mujoco.addresses import VECTORS, span
from mjcompose.mujoco.arrays import JOINT_TYPES, SWITCH, Treatment, about, words
from mjcompose.mujoco.attributes import HOLDERS, KINDS, ON_BODIES, NameTable, holder
from mjcompose.mujoco.compare import KeyMode, Roots, key_differences
from mjcompose.mujoco.controls import NO_BIAS, servo
from mjcompose.mujoco.match import ABSENT, MISSING, Correspondence, Difference, Mount, unequal_references, values
from mjcompose.mujoco.references import Array, links
from mjcompose.mujoco.unequal import Bound

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_TARGETS = 3


def named(roster: NameTable, kind: str, index: int) -> str:
    """Return an element's name; for an unnamed element that is not on a body, also its references."""
    name = roster.describe(kind, index)
    if not name.startswith("#") or kind in HOLDERS:
        return name
    targets = [each for each in links(roster.model, kind, index) if each.index >= 0][:_TARGETS]
    described = ", ".join(f"`{roster.describe(each.kind, each.index)}`" for each in targets)
    return f"{name} ({described})" if described else name


def relative_to_value(tolerance: float) -> Bound:
    """Return the bound of a tolerance that users set: relative to the larger value, at least to a millionth."""
    return Bound(tolerance, floor=1e-6)


def counts(a: MjModel, b: MjModel, tolerance: float) -> Iterator[SizeChange]:
    """Yield changes of vector sizes, of the numbers of elements, and of the total mass."""
    for name in ("nq", "nv", "nu", "na", "nmocap", "nsensordata"):
        if getattr(a, name) != getattr(b, name):
            yield SizeChange(name, int(getattr(a, name)), int(getattr(b, name)))
    for kind, known in KINDS.items():
        before, after = (len(getattr(model, known.addresses)) for model in (a, b))
        if before != after:
            yield SizeChange(kind, before, after)
    mass = float(a.body_mass.sum()), float(b.body_mass.sum())
    if not relative_to_value(max(tolerance, 1e-12)).allows(*mass):
        yield SizeChange("total mass", *mass, "kg")


def moves(matching: Correspondence) -> Iterator[AddressMove]:
    """Yield joints, actuators, sensors and mocap bodies of both models whose address in a vector changed."""
    a = matching.alone.model
    b = matching.composed.model
    for kind in ("joint", "actuator", "sensor", "body"):
        pairs = sorted(matching.pairs(kind), key=lambda pair: pair[1])
        for vector in (vector for vector, (of, _) in VECTORS.items() if of == kind):
            for index, target in pairs:
                before = span(a, vector, index)
                after = span(b, vector, target)
                if before and after and before.start != after.start:
                    name = matching.composed.describe(kind, target)
                    yield AddressMove(vector, kind, name, before=before.start, after=after.start)


_SPELLED = {"euler": "Euler", "rk4": "RK4", "pgs": "PGS", "cg": "CG", "newton": "Newton"}
_FLAGS = {"disableflags": ("mjtDisableBit", "mjDSBL_", True), "enableflags": ("mjtEnableBit", "mjENBL_", False)}


def setting_changes(mujoco: Any, a: MjModel, b: MjModel, tolerance: float) -> Iterator[FieldChange]:
    """Yield changes of settings, flags one by one, with words instead of numbers."""
    bound = relative_to_value(tolerance)
    for difference in compare.option_differences(a, b):
        if difference.name in _FLAGS:
            yield from _flags(mujoco, difference)
        elif not _is_close(difference.expected, difference.actual, bound):
            before, after = (_word(mujoco, difference.name, each) for each in (difference.expected, difference.actual))
            yield FieldChange("changed", difference.kind, "", field=difference.name, before=before, after=after)
    for difference in compare.statistic_differences(a, b):
        before = difference.expected
        after = difference.actual
        if not _is_close(before, after, bound):
            yield FieldChange(
                "changed", "statistic", "", field=difference.name, before=before, after=after, follows=True
            )


def _flags(mujoco: Any, difference: Difference) -> Iterator[FieldChange]:
    enum, prefix, disables = _FLAGS[difference.name]
    assert isinstance(difference.expected, int) and isinstance(difference.actual, int)
    for word, bit in getattr(mujoco, enum).__members__.items():
        if word.startswith(prefix) and (difference.expected ^ difference.actual) & int(bit):
            states = [bool(each & int(bit)) is not disables for each in (difference.expected, difference.actual)]
            before, after = ("enable" if state else "disable" for state in states)
            field = f"flag {word.removeprefix(prefix).lower()}"
            yield FieldChange("changed", "option", "", field=field, before=before, after=after)


def _word(mujoco: Any, name: str, value: Value) -> Value:
    if not about(name).enumeration or not isinstance(value, int):
        return value
    word = words(mujoco, name).get(value, value)
    return _SPELLED.get(str(word), word)


def _is_close(a: Value, b: Value, bound: Bound) -> bool:
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_is_close(x, y, bound) for x, y in zip(a, b, strict=True))
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return bound.allows(a, b)
    return a == b


_SHOWN = 12
_COUNTED = ("mesh_vert", "mesh_face")
"""Other arrays report these sizes."""

_SHAPES = ("mesh_", "hfield_", "tex_", "skin_", "flex_", "oct_")
"""The data of these is never listed number by number."""


class DifferingValues:
    """The numbers that differ, in the unit and words of MuJoCo's arrays."""

    def __init__(self, mujoco: Any, matching: Correspondence, tolerance: float) -> None:
        self.mujoco = mujoco
        self.matching = matching
        self.bound = relative_to_value(tolerance)
        self.a = matching.alone.model
        self.b = matching.composed.model

    def changes(self) -> Iterator[FieldChange]:
        """Yield changes in the order of kinds, and of elements in B."""
        unequal: dict[tuple[str, int, int], list[compare.Unequal]] = defaultdict(list)
        for each in compare.unequal_elements(self.matching, compare.Rules()):
            unequal[each.kind, each.target, each.index].append(each)
        kinds = list(KINDS)
        for kind, target, index in sorted(unequal, key=lambda of: (kinds.index(of[0]), of[1])):
            names = named(self.matching.alone, kind, index), named(self.matching.composed, kind, target)
            for field, before, after in self._of(unequal[kind, target, index]):
                note = str(after) if before is None and isinstance(after, str) else ""
                yield FieldChange(
                    "changed",
                    kind,
                    names[1],
                    field=field,
                    before=before,
                    after=None if note else after,
                    form=JOINT_TYPES[int(self.b.jnt_type[target])].word if kind == "joint" else "",
                    index=(index, target),
                    name_before=names[0],
                    follows=about(field).is_computed,
                    note=note,
                )

    def _of(self, unequal: list[compare.Unequal]) -> Iterator[tuple[str, Value, Value]]:
        first = unequal[0]
        gains = self._gains(first.index, first.target) if first.kind == "actuator" else None
        yield from gains or ()
        for each in sorted(unequal, key=lambda each: each.treatment is Treatment.DATA):
            if each.treatment is Treatment.DATA:
                yield from self._run(each.array, each.expected, each.actual)
            elif gains is None or each.array not in ("actuator_gainprm", "actuator_biasprm"):
                yield from self._row(each.array, each.expected.tolist(), each.actual.tolist())

    def _row(self, name: str, before: Any, after: Any) -> Iterator[tuple[str, Value, Value]]:
        known = about(name)
        if known.enumeration:
            of = words(self.mujoco, name)
            yield name, of.get(int(before), str(before)), of.get(int(after), str(after))
        elif SWITCH in known.traits or isinstance(before, bool):
            yield name, bool(before), bool(after)
        elif name.startswith("dof_"):  # a row for each degree of freedom
            yield from self._numbers(name, _one(before), _one(after))
        else:
            yield from self._numbers(name, before, after)

    def _numbers(self, name: str, before: Any, after: Any) -> Iterator[tuple[str, Value, Value]]:
        ours = _flat(before)
        others = _flat(after)
        different = [at for at, (x, y) in enumerate(zip(ours, others, strict=True)) if not self.bound.allows(x, y)]
        if different and len(ours) <= _SHOWN:
            yield name, _value(before), _value(after)
        else:
            yield from ((f"{name}[{at}]", ours[at], others[at]) for at in different[:_SHOWN])

    def _run(self, name: str, mine: Array, theirs: Array) -> Iterator[tuple[str, Value, Value]]:
        if name == "text_data":
            before, after = (bytes(run.tolist()).rstrip(b"\0").decode("utf-8", "replace") for run in (mine, theirs))
            if before != after:
                yield name, before, after
        elif mine.shape != theirs.shape:
            if mine.size <= _SHOWN and theirs.size <= _SHOWN and not name.startswith(_SHAPES):
                yield name, _value(_one(mine.tolist())), _value(_one(theirs.tolist()))
            elif name not in _COUNTED:
                yield name, f"{len(mine)} rows", f"{len(theirs)} rows"
        elif mine.size <= _SHOWN and not name.startswith(_SHAPES):
            before = mine.tolist()
            after = theirs.tolist()
            if before != after and name.endswith("limited"):
                yield name, bool(before[0]), bool(after[0])
            elif before != after:
                yield from self._numbers(name, _one(before), _one(after))
        else:
            pairs = zip(_flat(mine.tolist()), _flat(theirs.tolist()), strict=True)
            off = [abs(x - y) for x, y in pairs if not self.bound.allows(x, y)]
            if off:
                yield name, None, f"{len(off)} of {mine.size} numbers differ, by up to {max(off):.3g}"

    def _gains(self, index: int, target: int) -> list[tuple[str, Value, Value]] | None:
        """Return gains by name, if both models have the actuator in the same form."""
        before = _servo(self.a, index)
        after = _servo(self.b, target)
        if before is None or after is None or before.keys() != after.keys():
            return None
        pairs = ((name, value, after[name]) for name, value in before.items())
        return [pair for pair in pairs if not self.bound.allows(pair[1], pair[2])]


def _servo(model: MjModel, index: int) -> dict[str, float] | None:
    """Return the gains of a motor or servo without other parameters, which describe it completely."""
    gain = model.actuator_gainprm[index]
    bias = model.actuator_biasprm[index]
    beside = bias if int(model.actuator_biastype[index]) == NO_BIAS else bias[3:]
    return None if gain[1:].any() or beside.any() else servo(model, index)


def _flat(value: Any) -> list[float]:
    return [number for each in value for number in _flat(each)] if isinstance(value, list) else [value]


def _one(rows: list[Any]) -> Any:
    return rows[0] if rows and all(row == rows[0] for row in rows) else rows


def _value(value: Any) -> Any:
    return tuple(_value(each) for each in value) if isinstance(value, list) else value


Names = Mapping[str, Mapping[str, str]]
"""A's names mapped to B's, by kind; unchanged names are not listed."""

_ALIKE = 0.6
"""The share of names that two prefixes must have in common to count as one part."""

_SINGLE = (
    "body",
    "joint",
    "geom",
    "site",
    "camera",
    "light",
    "material",
    "mesh",
    "texture",
    "tendon",
    "actuator",
    "sensor",
)


def renames(a: NameTable, b: NameTable) -> dict[str, dict[str, str]]:
    """Return the names that changed. Only clear cases count: an element that also changed is another element."""
    lost = {kind: [name for name in a.ids[kind] if name not in b.ids[kind]] for kind in KINDS}
    new = {kind: [name for name in b.ids[kind] if name not in a.ids[kind]] for kind in KINDS}
    found: dict[str, dict[str, str]] = defaultdict(dict)
    for before, after in _prefixes(lost, new, a, b=b):
        for kind in KINDS:
            for name in lost[kind]:
                called = after + name.removeprefix(before)
                if name.startswith(before) and called in b.ids[kind]:
                    found[kind][name] = called
    for kind in _SINGLE:
        taken = set(found[kind].values())
        left = [name for name in lost[kind] if name not in found[kind]]
        free = [name for name in new[kind] if name not in taken]
        found[kind].update(_alike(kind, left, free, a=a, b=b, bodies=found["body"]))
    return {kind: names for kind, names in found.items() if names}


def _prefixes(
    lost: Mapping[str, list[str]], new: Mapping[str, list[str]], a: NameTable, b: NameTable
) -> list[tuple[str, str]]:
    """Return pairs of a prefix that only A has and a prefix that only B has, with similar names after them."""
    gone = _behind(lost, b)
    come = _behind(new, a)
    pairs = []
    for before, mine in gone.items():
        shares = {after: len(mine & theirs) / len(mine | theirs) for after, theirs in come.items()}
        best = max(shares, key=shares.__getitem__, default=None)
        if best is not None and shares[best] >= _ALIKE:
            pairs.append((before, best))
            del come[best]
    return pairs


def _behind(names: Mapping[str, list[str]], other: NameTable) -> dict[str, set[tuple[str, str]]]:
    """Return the names after each outermost prefix that the other model lacks."""
    known = {name.partition("/")[0] for by_name in other.ids.values() for name in by_name if "/" in name}
    found: dict[str, set[tuple[str, str]]] = defaultdict(set)
    for kind, by_name in names.items():
        for name in by_name:
            first, separator, rest = name.partition("/")
            if separator and first not in known:
                found[f"{first}/"].add((kind, rest))
    return found


def _alike(
    kind: str, lost: list[str], new: list[str], a: NameTable, b: NameTable, bodies: Mapping[str, str]
) -> dict[str, str]:
    """Return elements that have equal numbers and are on the same body, without ambiguous ones."""
    mine = _by_look(kind, lost if new else [], a, renamed=bodies)
    theirs = _by_look(kind, new if lost else [], b, renamed={})
    alone = {look: names[0] for look, names in theirs.items() if len(names) == 1}
    return {names[0]: alone[look] for look, names in mine.items() if len(names) == 1 and look in alone}


def _by_look(kind: str, names: list[str], roster: NameTable, renamed: Mapping[str, str]) -> dict[Hashable, list[str]]:
    found: dict[Hashable, list[str]] = defaultdict(list)
    for name in names:
        index = roster.ids[kind][name]
        owner = roster.names["body"][holder(roster.model, kind, index)] if kind in HOLDERS else ""
        found[(values(roster.model, kind, index), renamed.get(owner, owner))].append(name)
    return found


def contrast(mujoco: Any, a: MjModel, b: MjModel, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return a `Contrast` as JSON data; runs under `mjcompose.mujoco.engine.call`. ``given`` has the ``tolerance``.

    It may also have ``names``, which maps A's names to B's by kind if that is known. Then unnamed elements may be in a
    different order.
    """
    mine = NameTable(a)
    theirs = NameTable(b)
    known = given.get("names")
    names = renames(mine, theirs) if known is None else known
    matching = Correspondence(mine, theirs, prefix="", mount=Mount(), renamed=names, by_order=known is None)
    tolerance = float(given["tolerance"])
    values = DifferingValues(mujoco, matching, tolerance)
    changes = [
        *(_renamed(names, matching) if known is None else ()),
        *_presence(matching),
        *references(matching),
        *values.changes(),
        *_keys(matching, tolerance),
        *setting_changes(mujoco, a, b, tolerance=tolerance),
    ]
    arrays = [name for name, *_ in compare.unequal_attributes(a, b)]
    contrast = Contrast(
        identical=not arrays,
        changes=tuple(changes),
        moves=tuple(moves(matching)),
        counts=tuple(counts(a, b, tolerance)),
        arrays=() if changes else tuple(arrays),
        elements={kind: (mine.count(kind), theirs.count(kind)) for kind in KINDS},
    )
    return asdict(contrast)


def contrast_of(data: Mapping[str, Any]) -> Contrast:
    frozen = ({name: _value(value) for name, value in each.items()} for each in data["changes"])
    return Contrast(
        identical=data["identical"],
        changes=tuple(FieldChange(**each) for each in frozen),
        moves=tuple(AddressMove(**each) for each in data["moves"]),
        counts=tuple(SizeChange(**each) for each in data["counts"]),
        arrays=tuple(data["arrays"]),
        elements={kind: (a, b) for kind, (a, b) in data["elements"].items()},
    )


def _renamed(names: Names, matching: Correspondence) -> Iterator[FieldChange]:
    for kind, by_name in names.items():
        for before, after in by_name.items():
            index = matching.alone.ids[kind][before], matching.composed.ids[kind][after]
            yield FieldChange("renamed", kind, after, before=before, after=after, index=index, name_before=before)


def _presence(matching: Correspondence) -> Iterator[FieldChange]:
    """Yield elements that only one of the two models has; unnamed elements belong to their body."""
    lost = {kind: [i for i, j in enumerate(matching.ids[kind]) if j == ABSENT] for kind in KINDS}
    every = {kind: range(kind == "body", matching.composed.count(kind)) for kind in KINDS}  # the world is in both
    new = {kind: [j for j in every[kind] if j not in matching.taken[kind]] for kind in KINDS}
    for kind in (each for each in KINDS if each != "key"):
        for index in _alone_there(matching.alone, kind, lost):
            name = named(matching.alone, kind, index)
            yield FieldChange("removed", kind, name, index=(index, ABSENT), name_before=name)
        for index in _alone_there(matching.composed, kind, new):
            yield FieldChange("added", kind, named(matching.composed, kind, index), index=(ABSENT, index))


def _alone_there(roster: NameTable, kind: str, found: Mapping[str, list[int]]) -> Iterator[int]:
    """Yield the elements of a kind among the found elements, without unnamed elements on found bodies."""
    bodies = set(found["body"])
    for index in found[kind]:
        is_unnamed = kind in ON_BODIES and not roster.names[kind][index]
        if not (is_unnamed and holder(roster.model, kind, index) in bodies):
            yield index


def references(matching: Correspondence) -> Iterator[FieldChange]:
    for kind, index, target, mine, other in unequal_references(matching):
        link = mine or other
        assert link is not None
        before, after = (
            None if each is None or each.index < 0 else side.describe(each.kind, each.index)
            for each, side in ((mine, matching.alone), (other, matching.composed))
        )
        yield FieldChange(
            "changed",
            kind,
            named(matching.composed, kind, target),
            field=link.field,
            before=before,
            after=after,
            index=(index, target),
            name_before=named(matching.alone, kind, index),
            follows=about(link.field).is_computed,
        )


def _keys(matching: Correspondence, tolerance: float) -> Iterator[FieldChange]:
    """Yield changes of keyframes by joint, actuator and mocap body."""
    mine = matching.alone
    theirs = matching.composed
    types = matching.composed.model.jnt_type.tolist()
    joints = {theirs.describe("joint", j): JOINT_TYPES[types[j]].word for _, j in matching.pairs("joint")}
    for difference in key_differences(matching, None, KeyMode.MERGE, roots=Roots.KEPT, tolerance=tolerance):
        index = mine.ids["key"].get(difference.name, ABSENT)
        if difference.field == MISSING:
            yield FieldChange("removed", "key", difference.name, index=(index, ABSENT), name_before=difference.name)
            continue
        field, _, entry = difference.field.partition(" of ")
        name = entry.strip("`")
        before = _alone(difference.expected)
        after = _alone(difference.actual)
        both = index, theirs.ids["key"].get(difference.name, ABSENT)
        yield FieldChange(
            "changed",
            "key",
            difference.name,
            field=field,
            before=before,
            after=after,
            form=joints.get(name, ""),
            entry=name,
            index=both,
            name_before=difference.name,
        )
    known = set(mine.names["key"])
    for index, name in enumerate(theirs.names["key"]):
        if name not in known:
            yield FieldChange("added", "key", theirs.describe("key", index), index=(ABSENT, index))


def _alone(value: Value) -> Value:
    return value[0] if isinstance(value, tuple) and len(value) == 1 else value


def looks(mujoco: Any, *models_and_none: Any) -> list[dict[str, list[int]]]:
    """Return the geoms, meshes and cameras of each model that only a viewer or a renderer uses.

    It runs under `mjcompose.mujoco.engine.call`. A rangefinder meets every geom.
    """
    return [
        {
            "geom": sorted(found := _seen_only(mujoco, each)),
            "mesh": _meshes(mujoco, each, found),
            "camera": sorted({*range(each.ncam)} - _sensed(mujoco, each, "CAMERA")),
        }
        for each in models_and_none[:-1]
    ]


def _sensed(mujoco: Any, model: MjModel, kind: str) -> set[int]:
    ends = ((model.sensor_objtype, model.sensor_objid), (model.sensor_reftype, model.sensor_refid))
    wanted = int(getattr(mujoco.mjtObj, f"mjOBJ_{kind}"))
    return {int(each) for types, ids in ends for each in ids[types == wanted]}


def _seen_only(mujoco: Any, model: MjModel) -> set[int]:
    if (model.sensor_type == int(mujoco.mjtSensor.mjSENS_RANGEFINDER)).any():
        return set()
    wraps = [int(getattr(mujoco.mjtWrap, f"mjWRAP_{each}")) for each in ("SPHERE", "CYLINDER")]
    used = {int(each) for wrap in wraps for each in model.wrap_objid[model.wrap_type == wrap]}
    used |= {*model.pair_geom1.tolist(), *model.pair_geom2.tolist()} | _sensed(mujoco, model, "GEOM")
    free = (model.geom_contype == 0) & (model.geom_conaffinity == 0) & (model.geom_plugin < 0)
    free &= model.geom_fluid[:, 0] == 0
    return {int(each) for each in free.nonzero()[0]} - used


def _meshes(mujoco: Any, model: MjModel, seen_only: set[int]) -> list[int]:
    types = [int(getattr(mujoco.mjtGeom, f"mjGEOM_{each}")) for each in ("MESH", "SDF")]
    used = {int(model.geom_dataid[at]) for at in {*range(model.ngeom)} - seen_only if int(model.geom_type[at]) in types}
    return sorted({*range(model.nmesh)} - used)
