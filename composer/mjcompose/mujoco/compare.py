"""Compare compiled models by the table of arrays, element by element or every attribute of `mjModel`, and their keys.

The caller says which elements belong together, which differences are allowed, and how to report a difference. This
module finds the numbers that differ.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Collection, Iterator
from enum import StrEnum
from operator import attrgetter
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from mjcompose.base.dataclass import Struct
from mjcompose.base.rotation import Pose, rotate
from mjcompose.mujoco.addresses import RUNS, runs, span
from mjcompose.mujoco.arrays import FREE, ROUNDING, Treatment, with_trait
from mjcompose.mujoco.attributes import KINDS, NameTable
from mjcompose.mujoco.match import ABSENT, MISSING, Correspondence, Difference, Value
from mjcompose.mujoco.references import DOF, Array, arrays, same_width
from mjcompose.mujoco.unequal import Bound, differing_rows, unequal

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Pairs = list[tuple[int, int]]
"""The ids of elements in both models."""
Run = tuple[Array, Array]
"""The data of an element in both models."""
_NOT_ROWS = (Treatment.SKIPPED, Treatment.LINKED, Treatment.DATA)


class Unequal(Struct, eq=False):
    """The numbers of an array that differ for one element: in its own row, or in several rows.

    ``expected`` are the numbers of the first model as they should be in the second model, and ``actual`` are the
    numbers in the second model. ``different`` marks the differing numbers, or is None if the element has a different
    number of rows there.
    """

    kind: str
    index: int
    target: int
    array: str
    treatment: Treatment
    expected: Array
    actual: Array
    different: NDArray[np.bool_] | None


class Rules:
    """The allowed differences: none, bit for bit. Other rules override this."""

    def ignores(self, kind: str, array: str, index: int) -> bool:
        """Return whether an array has no information about this element of the first model."""
        return False

    def expected(self, array: str, pairs: Pairs, mine: Array, theirs: Array) -> Array:
        """Return the rows of elements as they should be in the second model, which has the array ``theirs``."""
        return mine

    def bound(self, treatment: Treatment) -> float:
        """Return the allowed difference of numbers, relative to the larger of 1 and the number."""
        return 0.0

    def excuses(self, treatment: Treatment, kind: str, array: str, pair: tuple[int, int]) -> bool:
        """Return whether a difference in a row follows from the second model itself."""
        return False

    def run(self, kind: str, array: str, index: int, run: Run) -> tuple[*Run, float] | None:
        """Return the data of an element that must be equal, and the allowed difference; None if it may differ."""
        return *run, 0.0


def unequal_elements(matching: Correspondence, rules: Rules) -> Iterator[Unequal]:
    """Yield differences between elements of both models by array and kind, not references and keys. Dofs come last."""
    for kind in KINDS:
        if kind != "key":
            pairs = matching.pairs(kind)
            rows = [[i for i, _ in pairs], [j for _, j in pairs]]
            yield from _unequal_rows(matching, rules, kind, pairs=pairs, rows=rows)
            yield from _unequal_runs(matching, rules, kind)
    alone = matching.alone.model
    composed = matching.composed.model
    pairs = []
    rows = [[], []]
    for index, target in matching.pairs("joint"):
        if int(alone.jnt_type[index]) == int(composed.jnt_type[target]):
            own = span(alone, "qvel", index)
            rows[0] += own
            rows[1] += span(composed, "qvel", target)
            pairs += [(index, target)] * len(own)
    yield from _unequal_rows(matching, rules, DOF, pairs=pairs, rows=rows)


def _unequal_rows(
    matching: Correspondence, rules: Rules, group: str, pairs: Pairs, rows: list[list[int]]
) -> Iterator[Unequal]:
    """Compare the arrays of a group at these rows of both models; each row belongs to one of the pairs."""
    kind = "joint" if group == DOF else group
    if not pairs:
        return
    starts = _starts(pairs)
    ends = [*starts[1:], len(pairs)]
    composed = {name: array for name, array, _ in arrays(matching.composed.model, group)}
    for name, array, treatment in arrays(matching.alone.model, group):
        if treatment in _NOT_ROWS or name not in composed:
            continue
        theirs = composed[name]
        expected, actual = _as_compared(
            treatment,
            rules.expected(name, pairs, mine=array[rows[0]], theirs=theirs),
            theirs[rows[1]],
        )
        if not expected.size:
            continue
        different = unequal(expected, actual, Bound(rules.bound(treatment)))
        for at in sorted({bisect_right(starts, row) - 1 for row in differing_rows(different)}):
            pair = pairs[starts[at]]
            first = starts[at]
            if rules.ignores(kind, name, pair[0]) or rules.excuses(treatment, kind, name, pair=pair):
                continue
            own: Any = slice(first, ends[at]) if group == DOF else first
            yield Unequal(
                kind,
                *pair,
                array=name,
                treatment=treatment,
                expected=expected[own],
                actual=actual[own],
                different=different[own],
            )


def _starts(pairs: Pairs) -> list[int]:
    """Return the first row of each pair: a joint has a row for each of its dofs."""
    return [at for at, pair in enumerate(pairs) if not at or pair != pairs[at - 1]]


def _as_compared(treatment: Treatment, expected: Array, actual: Array) -> tuple[Array, Array]:
    """Return the values to compare: of some arrays, only whether there is something; of user data, the same width."""
    if treatment is Treatment.PRESENT:
        return np.not_equal(expected, -1), np.not_equal(actual, -1)
    if treatment is Treatment.USER:
        return same_width(expected, actual)
    return expected, actual


def _unequal_runs(matching: Correspondence, rules: Rules, kind: str) -> Iterator[Unequal]:
    for index, target in matching.pairs(kind):
        theirs = dict(runs(matching.composed.model, kind, target))
        for name, mine in runs(matching.alone.model, kind, index):
            other = theirs.get(name)
            if other is None or rules.ignores(kind, name, index):
                continue
            different = None
            if mine.shape == other.shape:
                compared = rules.run(kind, name, index, run=(mine, other))
                if compared is None:
                    continue
                mine, other, bound = compared
                different = unequal(mine, other, Bound(bound))
                if not different.any():
                    continue
            yield Unequal(
                kind,
                index,
                target,
                array=name,
                treatment=Treatment.DATA,
                expected=mine,
                actual=other,
                different=different,
            )


_VISUAL = ("global_", "quality", "headlight", "map", "scale", "rgba")
_OF_THE_PLACE = with_trait("path") | {"paths", "npaths", "nbuffer"}
"""File paths at compilation, and the memory for them, which are not part of the model itself."""


def unequal_attributes(a: MjModel, b: MjModel) -> Iterator[tuple[str, Any, Any]]:
    """Yield the attributes of `mjModel` that differ, including `opt.timestep` and the like, with both values.

    NaN equals NaN. Both models must come from the same MuJoCo: an attribute that only the first model has counts as
    different, and its second value is None.
    """
    for path in ("", "opt", *(f"vis.{group}" for group in sorted(_VISUAL)), "stat"):
        mine, theirs = (attrgetter(path)(model) if path else model for model in (a, b))
        yield from _unequal(path and f"{path}.", mine, theirs)


def _unequal(prefix: str, mine: Any, theirs: Any) -> Iterator[tuple[str, Any, Any]]:
    for name in dir(mine):
        value = None if name.startswith("_") or name in _OF_THE_PLACE else getattr(mine, name)
        if isinstance(value, int | float | str | bytes | np.ndarray):
            other = getattr(theirs, name, None)
            if isinstance(value, np.ndarray) and isinstance(other, np.ndarray):
                differs = value.shape != other.shape or unequal(value, other).any()
            else:
                differs = value != other and (value == value or other == other)
            if differs:
                yield prefix + name, value, other


def option_differences(alone: MjModel, composed: MjModel) -> list[Difference]:
    """Return the settings of `opt` and `vis` that differ. They do not change a part, but its author wrote them."""
    found = _settings("option", alone.opt, composed.opt)
    for group in _VISUAL:
        found += _settings(f"visual/{group.rstrip('_')}", *(getattr(each.vis, group) for each in (alone, composed)))
    return found


def statistic_differences(alone: MjModel, composed: MjModel) -> list[Difference]:
    """Return the numbers of `stat` that differ, written or computed."""
    return _settings("statistic", alone.stat, composed.stat)


def _settings(kind: str, mine: Any, theirs: Any) -> list[Difference]:
    return [
        Difference(kind, name, "value", expected=plain_value(before), actual=plain_value(after))
        for name, before, after in _unequal("", mine, theirs)
    ]


def plain_value(numbers: Any) -> Value:
    """Return an array as nested tuples of numbers."""
    array = np.asarray(numbers)
    return tuple(map(plain_value, array)) if array.ndim else array.item()


Entry = tuple[str, Array, Array, float]
"""The name of a row of a key, its numbers alone and in the composition, and how far apart they may be."""


class KeyMode(StrEnum):
    """How a part's keys are composed (`keys:` and `drop` of a recipe)."""

    MERGE = "merge"
    """Keys of the same name in several parts become one key of that name."""
    PREFIX = "prefix"
    """Each is a key of its own with the part's prefix."""
    NONE = "none"


class Roots(StrEnum):
    """What happens in keys to free joints and mocap bodies at the root of a part that is moved."""

    MOVED = "moved"
    """They move with the part."""
    KEPT = "kept"
    """The numbers stay, as `MjSpec.attach` leaves them."""


def key_differences(
    matching: Correspondence,
    transform: Pose | None,
    keys: KeyMode,
    roots: Roots,
    tolerance: float = 0.0,
    replaced: Collection[str] = (),
) -> list[Difference]:
    """Return the differences between keys for the part's own joints, actuators and mocap bodies.

    ``transform`` is the pose of the part's world in the composition's; None or the identity moves nothing. Keys of
    the composition that are ``replaced`` are not compared, because their values were written on purpose.
    """
    found: list[Difference] = []
    if keys is KeyMode.NONE:
        return found
    moved = transform if roots is Roots.MOVED and transform is not None and not transform.is_identity else None
    for key, target in _match(matching, keys, moved):
        name = matching.alone.describe("key", key)
        if target == ABSENT:
            found.append(Difference("key", name, MISSING, expected=True, actual=False))
            continue
        if matching.composed.names["key"][target] in replaced:
            continue
        there = matching.composed.describe("key", target)
        pairs = list(_entries(matching, key, target, moved=moved))
        if keys is KeyMode.PREFIX:
            alone = matching.alone.model
            composed = matching.composed.model
            pairs.append(("key_time", alone.key_time[key : key + 1], composed.key_time[target : target + 1], 0.0))
        for field, mine, theirs, bound in pairs:
            if mine.shape != theirs.shape or unequal(mine, theirs, Bound(max(bound, tolerance))).any():
                expected = tuple(mine.tolist())
                actual = tuple(theirs.tolist())
                found.append(Difference("key", there, field, expected=expected, actual=actual))
    return found


def _match(matching: Correspondence, keys: KeyMode, moved: Pose | None) -> Iterator[tuple[int, int]]:
    """Yield keys of the part and of the composition; unnamed keys are matched by order."""
    alone = matching.alone
    composed = matching.composed
    given = matching.renamed.get("key", {})
    unnamed: list[int] = []
    taken: set[int] = set()
    for index, name in enumerate(alone.names["key"]):
        if not name:
            unnamed.append(index)
            continue
        there = given.get(name, name if keys is KeyMode.MERGE else matching.prefix + name)
        # A key of a model that MuJoCo itself attaches to the part has the prefix, whatever happens to the others.
        found = [composed.ids["key"][each] for each in (there, matching.prefix + name) if each in composed.ids["key"]]
        alike = (each for each in found if not _says_otherwise(matching, index, each, moved=moved))
        target = next(alike, found[0] if found else ABSENT)
        taken.add(target)
        yield index, target
    free = [(i, name) for i, name in enumerate(composed.names["key"]) if i not in taken]
    left = [i for i, name in free if not name or (matching.prefix and name.startswith(matching.prefix))]
    for index in unnamed:
        alike = (i for i in left if not _says_otherwise(matching, index, i, moved=moved))
        target = next(alike, left[0] if left else ABSENT)
        if target != ABSENT:
            left.remove(target)
        yield index, target


def _says_otherwise(matching: Correspondence, key: int, target: int, moved: Pose | None) -> bool:
    return any(
        mine.shape != theirs.shape or unequal(mine, theirs, Bound(bound)).any()
        for _, mine, theirs, bound in _entries(matching, key, target, moved=moved)
    )


def _entries(matching: Correspondence, key: int, target: int, moved: Pose | None) -> Iterator[Entry]:
    yield from _of_joints(matching, key, target, moved=moved)
    alone = matching.alone.model
    composed = matching.composed.model
    for actuator, there in matching.pairs("actuator"):
        name = matching.composed.describe("actuator", there)
        for vector in ("ctrl", "act"):
            mine = _entry(alone, vector, key, index=actuator)
            theirs = _entry(composed, vector, target, index=there)
            yield f"key_{vector} of `{name}`", mine, theirs, 0.0
    for kind in ("tendon", "flex"):
        for index, there in matching.pairs(kind):
            yield from _plastic(matching, kind, key, target=target, index=index, there=there)
    yield from _of_mocap_bodies(matching, key, target, moved=moved)


def _of_joints(matching: Correspondence, key: int, target: int, moved: Pose | None) -> Iterator[Entry]:
    alone = matching.alone.model
    composed = matching.composed.model
    for joint, there in matching.pairs("joint"):
        if alone.jnt_type[joint] != composed.jnt_type[there]:
            continue
        name = matching.composed.describe("joint", there)
        mine_q = _entry(alone, "qpos", key, index=joint)
        theirs_q = _entry(composed, "qpos", target, index=there)
        mine_v = _entry(alone, "qvel", key, index=joint)
        theirs_v = _entry(composed, "qvel", target, index=there)
        bound = 0.0
        if int(alone.jnt_type[joint]) == FREE and moved is not None:
            # Its linear velocity is in the frame of the world, and its angular velocity in the frame of the body.
            mine_v = np.array([*rotate(moved.quat, mine_v[:3].tolist()), *mine_v[3:].tolist()])
            mine_q, theirs_q = _moved(mine_q, theirs_q, moved)
            bound = ROUNDING
        yield f"key_qpos of `{name}`", mine_q, theirs_q, bound
        yield f"key_qvel of `{name}`", mine_v, theirs_v, bound
        yield from _plastic(matching, "joint", key, target=target, index=joint, there=there)


def _of_mocap_bodies(matching: Correspondence, key: int, target: int, moved: Pose | None) -> Iterator[Entry]:
    alone = matching.alone.model
    composed = matching.composed.model
    for body, there in matching.pairs("body"):
        if alone.body_mocapid[body] < 0 or composed.body_mocapid[there] < 0:
            continue
        name = matching.composed.describe("body", there)
        mine = _mocap(alone, key, body)
        theirs = _mocap(composed, target, there)
        bound = 0.0
        if moved is not None:
            mine, theirs = _moved(mine, theirs, moved)
            bound = ROUNDING
        yield f"key_mpos of `{name}`", mine[:3], theirs[:3], bound
        yield f"key_mquat of `{name}`", mine[3:], theirs[3:], bound


def _entry(model: MjModel, vector: str, key: int, index: int) -> Array:
    return _cut(model, vector, key, rows=span(model, vector, index))


def _cut(model: MjModel, vector: str, key: int, rows: range) -> Array:
    numbers: Array = getattr(model, f"key_{vector}")[key, rows.start : rows.stop]
    return numbers


def _mocap(model: MjModel, key: int, body: int) -> Array:
    at = int(model.body_mocapid[body])
    pos = model.key_mpos[key, 3 * at : 3 * at + 3]
    quat = model.key_mquat[key, 4 * at : 4 * at + 4]
    return np.concatenate([pos, quat])


def _plastic(matching: Correspondence, kind: str, key: int, target: int, index: int, there: int) -> Iterator[Entry]:
    if not hasattr(matching.alone.model, "key_plastic"):
        return
    alone = matching.alone.model
    composed = matching.composed.model
    run = RUNS[kind]["nplastic"]
    mine = _cut(alone, "plastic", key, rows=run.rows(alone, index))
    theirs = _cut(composed, "plastic", target, rows=run.rows(composed, there))
    if mine.size or theirs.size:
        # By default it is the length in the reference configuration, measured in the world.
        bound = ROUNDING if kind == "tendon" else 0.0
        yield f"key_plastic of `{matching.composed.describe(kind, there)}`", mine, theirs, bound


def _moved(state: Array, other: Array, transform: Pose) -> tuple[Array, Array]:
    """Return the moved pose, and the other pose with its quaternion in the same hemisphere."""
    x, y, z, w, a, b, c = state.tolist()
    pose = transform @ Pose((x, y, z), (w, a, b, c))
    quat = np.asarray(other[3:], dtype=np.float64)
    aligned = quat if float(quat @ np.array(pose.quat)) >= 0 else -quat
    return np.array([*pose.pos, *pose.quat]), np.concatenate([np.asarray(other[:3]), aligned])


_MOCAP = {"mpos": 3, "mquat": 4}


def key_rows(mujoco: Any, whole: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    """Compile bare models, and describe them and the keys of the whole model.

    `asked` has the texts of the bare models (the last one is for the whole model), the first letter of the names that
    they give to unnamed elements, and the questions for `hold`. The answer has a description of each bare model, None
    if MuJoCo refuses it, a description of the whole model, with its reference configuration as another key, and the
    answers of `hold`. It has `unlike` if the last bare model does not match the whole model.
    """
    bare: list[dict[str, Any] | None] = []
    refused = ""
    for text in asked["texts"]:
        try:
            bare.append(_described(mujoco.MjModel.from_xml_string(text)))
        except ValueError as error:
            bare.append(None)
            refused = " ".join(str(error).split())
    described = _described(whole)
    unlike = refused if bare[-1] is None else _unlike(bare[-1], described, asked["mark"])
    if unlike:
        return {"unlike": unlike}
    reference = {
        "qpos": whole.qpos0.tolist(),
        "qvel": [0.0] * whole.nv,
        "act": [0.0] * whole.na,
        "ctrl": [0.0] * whole.nu,
        "mpos": whole.body_pos[_mocaps(whole)].ravel().tolist(),
        "mquat": whole.body_quat[_mocaps(whole)].ravel().tolist(),
    }
    held = []
    if asked["held"]:
        from mjcompose.mujoco.controls import hold  # few keys hold a pose

        held = [hold(mujoco, whole, question) for question in asked["held"]]
    return {"bare": bare, "keys": described["keys"], "reference": reference, "held": held}


def _described(model: MjModel) -> dict[str, Any]:
    """Return the holders of numbers by vector, as name, name of the body, number on the body and rows; and the keys."""
    names = NameTable(model).names
    joints = [
        (names["joint"][at], names["body"][body], at - int(model.body_jntadr[body]))
        for at, body in enumerate(model.jnt_bodyid.tolist())
    ]
    actuators = [(name, "", 0) for name in names["actuator"]]
    holders: dict[str, list[list[Any]]] = {}
    for vector, named in (("qpos", joints), ("qvel", joints), ("act", actuators), ("ctrl", actuators)):
        rows = [span(model, vector, at) or range(0) for at in range(len(named))]
        holders[vector] = [[*each, own.start, own.stop] for each, own in zip(named, rows, strict=True)]
    mocaps = [names["body"][at] for at in _mocaps(model)]
    for vector, width in _MOCAP.items():
        holders[vector] = [[name, "", 0, at * width, (at + 1) * width] for at, name in enumerate(mocaps)]
    keys = [{vector: getattr(model, f"key_{vector}")[at].tolist() for vector in holders} for at in range(model.nkey)]
    return {"holders": holders, "keys": keys}


def _mocaps(model: MjModel) -> list[int]:
    return [int(at) for at in np.argsort(model.body_mocapid, kind="stable") if model.body_mocapid[at] >= 0]


def _unlike(bare: dict[str, Any], whole: dict[str, Any], mark: str) -> str:
    for vector, holders in whole["holders"].items():
        found = bare["holders"][vector]
        if len(found) != len(holders):
            return f"{len(holders)} elements have `{vector}`, not {len(found)}"
        for ours, theirs in zip(found, holders, strict=True):
            if ours[3:] != theirs[3:] or (not ours[0].startswith(mark) and ours[0] != theirs[0]):
                return f"`{vector}` of `{theirs[0] or theirs[1]}` is elsewhere"
    return ""
