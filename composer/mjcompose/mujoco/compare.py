"""A part alone compared with the part in a composition, number by number.

Stiffness and damping that MuJoCo computes from the inertia of the whole model.

A part with a damping ratio gets another damping if something heavy is attached to it; it is unchanged as long as
the ratio is. The compiled model does not store the ratio, but it follows from the gain and the inertia in the same
model.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from itertools import pairwise

import numpy as np

from mjcompose.base.rotation import Pose, multiply, rotate
from mjcompose.mujoco.addresses import FROM_THE_WORLD, IN_THE_WORLD, rows_of, runs, span
from mjcompose.mujoco.arrays import (
    AUTHORED_SLEEP,
    BEFORE_CONTROLS,
    DERIVED_ROUNDING,
    HULL,
    ROUNDING,
    SLIDE,
    Rule,
    Treatment,
)
from mjcompose.mujoco.attributes import HOLDERS, KINDS, Model, NameTable, holder
from mjcompose.mujoco.controls import servo
from mjcompose.mujoco.keyframes import Keys, Roots, key_differences
from mjcompose.mujoco.match import (
    ABSENT,
    Correspondence,
    Coupling,
    Difference,
    Mount,
    Value,
    presence_differences,
    reference_differences,
)
from mjcompose.mujoco.references import (
    DOF,
    ON_JOINTS,
    ON_TENDON,
    WRAP_JOINT,
    WRAP_SITE,
    Array,
    links,
    same_width,
    twists_a_rod,
    unequal,
)
from mjcompose.mujoco.references import arrays as arrays_rows

_OF_FLEXES = "MuJoCo does not turn the axes of a flex's vertices with a frame"
_POSED = {"body": "body", "geom": "geom", "site": "site", "camera": "cam"}


class Placing:
    """The rigid transform from the part's world to the frame of the mount's body: metres, and w x y z.

    ``transform`` is the mount's pose or, if that is unknown, the movement of the first root; None for a part with
    nothing at its root.
    """

    def __init__(self, matching: Correspondence, mount: Mount) -> None:
        self.matching = matching
        self.roots: dict[str, list[int]] = {"body": [], "light": [], **{kind: [] for kind in _POSED}}
        alone = matching.alone.model
        for kind, roots in self.roots.items():
            parents = getattr(alone, HOLDERS[kind])
            found = matching.ids[kind]
            roots += [
                i for i, parent in enumerate(parents.tolist())
                if parent == 0 and found[i] != ABSENT
                and not (kind == "body" and (i == 0 or twists_a_rod(alone, i)))
            ]  # fmt: skip
        self.transform = mount.pose if mount.pose is not None else self._first()

    def _first(self) -> Pose | None:
        for kind in _POSED:
            for index in self.roots[kind]:
                return self._there(kind, index) @ _pose(self.matching.alone.model, kind, index).inverse()
        return None

    def _there(self, kind: str, index: int) -> Pose:
        """Return the pose of a root's counterpart in the frame of the mount, through bodies in between."""
        model, target = self.matching.composed.model, self.matching.ids[kind][index]
        pose = _pose(model, kind, target)
        return self._frame(holder(model, kind, target)) @ pose

    def _frame(self, body: int) -> Pose:
        model, pose = self.matching.composed.model, Pose()
        while body != self.matching.mount and body in self.matching.worlds:
            pose = _pose(model, "body", body) @ pose
            body = int(model.body_parentid[body])
        return pose

    def seen_from(self, body: int) -> Pose:
        """Return the pose of the part's world in a body that holds it; the part's own where nothing says it."""
        return self._frame(body).inverse() @ (self.transform or Pose())

    def differences(self, tolerance: float = 0.0) -> list[Difference]:
        """Return the roots that did not move with the others, for a part that is moved."""
        found: list[Difference] = []
        if self.transform is None:
            return found
        bound = max(ROUNDING, tolerance)
        vertices = set(self.matching.alone.model.flex_vertbodyid.tolist())
        for kind, arrays in _POSED.items():
            for index in self.roots[kind]:
                expected = self.transform @ _pose(self.matching.alone.model, kind, index)
                actual = self._there(kind, index)
                name = self.matching.composed.describe(kind, self.matching.ids[kind][index])
                if not _near(expected.pos, actual.pos, bound):
                    found.append(
                        Difference(kind, name, f"{arrays}_pos", expected=expected.pos, actual=actual.pos)
                    )
                turned = tuple(-x for x in actual.quat)
                if not _near(expected.quat, actual.quat, bound) and not _near(expected.quat, turned, bound):
                    why = _OF_FLEXES if kind == "body" and index in vertices else ""
                    found.append(
                        Difference(
                            kind, name, f"{arrays}_quat", expected=expected.quat, actual=actual.quat, why=why
                        )
                    )
        found += self._lights(bound)
        return found

    def _lights(self, bound: float) -> list[Difference]:
        assert self.transform is not None
        found: list[Difference] = []
        alone, composed = self.matching.alone.model, self.matching.composed.model
        for index in self.roots["light"]:
            target = self.matching.ids["light"][index]
            frame = self._frame(int(composed.light_bodyid[target]))
            name = self.matching.composed.describe("light", target)
            expected = (self.transform @ Pose(_vec(alone.light_pos[index]))).pos
            actual = (frame @ Pose(_vec(composed.light_pos[target]))).pos
            if not _near(expected, actual, bound):
                found.append(Difference("light", name, "light_pos", expected=expected, actual=actual))
            expected = rotate(self.transform.quat, _vec(alone.light_dir[index]))
            actual = rotate(frame.quat, _vec(composed.light_dir[target]))
            if not _near(expected, actual, bound):
                found.append(Difference("light", name, "light_dir", expected=expected, actual=actual))
        return found


def _vec(values: Model) -> tuple[float, float, float]:
    x, y, z = values.tolist()
    return (x, y, z)


def _pose(model: Model, kind: str, index: int) -> Pose:
    arrays = _POSED[kind]
    w, x, y, z = getattr(model, f"{arrays}_quat")[index].tolist()
    return Pose(_vec(getattr(model, f"{arrays}_pos")[index]), (w, x, y, z))


def _near(a: tuple[float, ...], b: tuple[float, ...], bound: float) -> bool:
    return bool(np.allclose(a, b, rtol=bound, atol=bound, equal_nan=True))


_WELD = 1  # mjEQ_WELD
_ONE_POINT = 1e-9
"""Metres; at this distance the direction between two points is made of rounding errors."""
_SHOWN = 12
"""Longer rows are shown by their first differing entry."""


class Values:
    """Compares every array that belongs to an element, by the rules in ``fields``."""

    def __init__(
        self, matching: Correspondence, coupling: Coupling, placing: Placing, tolerance: float
    ) -> None:
        self.matching, self.coupling, self.placing, self.tolerance = matching, coupling, placing, tolerance
        self.alone, self.composed = matching.alone.model, matching.composed.model

    def differences(self) -> list[Difference]:
        found: list[Difference] = []
        for kind in KINDS:
            if kind != "key":
                pairs = self.matching.pairs(kind)
                found += self._rows(
                    kind, kind, pairs, mine=[i for i, _ in pairs], theirs=[j for _, j in pairs]
                )
                found += self._runs(kind)
        found += self._dofs()
        found += self._sleep()
        return found

    def _dofs(self) -> list[Difference]:
        """Compare the arrays with one row for each degree of freedom, by joint."""
        pairs: list[tuple[int, int]] = []
        mine: list[int] = []
        theirs: list[int] = []
        for index, target in self.matching.pairs("joint"):
            if int(self.alone.jnt_type[index]) == int(self.composed.jnt_type[target]):
                mine += (own := span(self.alone, "qvel", index))
                theirs += span(self.composed, "qvel", target)
                pairs += [(index, target)] * len(own)
        return list(dict.fromkeys(self._rows("joint", DOF, pairs, mine=mine, theirs=theirs)))

    def _rows(
        self, kind: str, group: str, pairs: list[tuple[int, int]], mine: list[int], theirs: list[int]
    ) -> list[Difference]:
        """Compare the arrays of a group at ``mine`` alone and ``theirs`` composed: the rows of ``pairs``."""
        found: list[Difference] = []
        if not pairs:
            return found
        composed = {name: array for name, array, _ in arrays_rows(self.composed, group)}
        for name, array, how in arrays_rows(self.alone, group):
            other = composed.get(name)
            if other is not None:
                expected = array[mine]
                if name == "eq_data" and not self.coupling.in_place:
                    expected = np.array([self._moved(*pair, other[pair[1]]) for pair in pairs])
                found += self._array(kind, name, how, pairs=pairs, expected=expected, actual=other[theirs])
        return found

    def _array(
        self,
        kind: str,
        name: str,
        how: Rule | None,
        pairs: list[tuple[int, int]],
        expected: Array,
        actual: Array,
    ) -> list[Difference]:
        treatment = how.treatment if how else Treatment.PLAIN
        if treatment in (Treatment.SKIPPED, Treatment.LINKED, Treatment.DATA):
            if name not in BEFORE_CONTROLS or hasattr(self.alone, "actuator_ctrladr"):
                return []
            treatment = BEFORE_CONTROLS[name]
        if treatment is Treatment.PRESENT:
            expected, actual = np.not_equal(expected, -1), np.not_equal(actual, -1)
        elif treatment is Treatment.USER:
            expected, actual = same_width(expected, actual)
        if not expected.size:
            return []
        different = unequal(expected, actual, self._bound(treatment)).reshape(len(expected), -1)
        return [
            self._difference(kind, pairs[row][1], name, expected=expected[row], actual=actual[row])
            for row in np.flatnonzero(different.any(axis=1)).tolist()
            if not self._excused(treatment, kind, name, *pairs[row])
        ]

    def _moved(self, index: int, target: int, actual: Array) -> Array:
        """Return the numbers of an equality, with what they measure in the part's world where the part is."""
        data = np.array(self.alone.eq_data[index])
        first, second = links(self.alone, "equality", index)
        of_world = [link.kind == "body" and link.index == 0 for link in (first, second)]
        if not any(of_world):
            return data
        ids = (self.composed.eq_obj1id[target], self.composed.eq_obj2id[target])
        pose = self.placing.seen_from(int(ids[of_world.index(True)]))
        # A `connect` has the point in the first body and then that in the second. A `weld` has them the other way
        # round, and then the rotation of the second body in the first.
        is_weld = int(self.alone.eq_type[index]) == _WELD
        at = 3 if of_world[0] == is_weld else 0
        x, y, z = data[at : at + 3].tolist()
        data[at : at + 3] = (pose @ Pose((x, y, z))).pos
        if is_weld:
            w, a, b, c = data[6:10].tolist()
            turn = (
                multiply(pose.quat, (w, a, b, c))
                if of_world[0]
                else multiply((w, a, b, c), pose.inverse().quat)
            )
            data[6:10] = np.array(turn) * (1.0 if np.dot(turn, actual[6:10]) >= 0 else -1.0)
        return data

    def _bound(self, treatment: Treatment) -> float:
        if treatment in (Treatment.ROUNDED, Treatment.GAIN) and not self.coupling.in_place:
            return max(ROUNDING, self.tolerance)
        if treatment is Treatment.DERIVED:
            return max(DERIVED_ROUNDING, self.tolerance)
        return self.tolerance

    def _excused(self, treatment: Treatment, kind: str, name: str, index: int, target: int) -> bool:
        """Return whether a difference in this row only follows from the part's place in the composition."""
        coupling, moved = self.coupling, not self.coupling.in_place
        if name in HULL and self._hull_for_others(kind, index):
            return True
        match treatment:
            case Treatment.ROOT_POSE:
                if kind == "body" and twists_a_rod(self.alone, index):
                    return True  # it has no place: only its angle counts
                return moved and self._at_root(kind, index)
            case Treatment.HOST:
                on_host = self._body(kind, index) in coupling.hosts
                return on_host or (moved and kind != "body" and self._at_root(kind, index))
            case Treatment.SUBTREE:
                return index in coupling.carriers
            case Treatment.LENS:
                return not self.alone.cam_sensorsize[index].any()
            case Treatment.DERIVED:
                acted_on = self._acted_on(kind, index) or self._less_simple(kind, index)
                return acted_on or (moved and kind == "tendon" and self._has_no_direction(index))
            case Treatment.GAIN if kind == "actuator":
                return same_dampratio(self.alone, self.composed, index, target=target)
            case Treatment.GAIN:
                same = same_stiffness if name == "jnt_stiffness" else same_damping
                seen_otherwise = self._acted_on(kind, index) or self._less_simple(kind, index)
                return seen_otherwise and same(self.alone, self.composed, index, target)
            case Treatment.ROUNDED:
                return moved and name == "flex_size"
            case _:
                return False

    def _hull_for_others(self, kind: str, index: int) -> bool:
        """Return whether nothing of the part collides with this mesh; only then MuJoCo computes no convex hull."""
        return kind == "mesh" and int(self.alone.mesh_graphadr[index]) < 0

    def _at_root(self, kind: str, index: int) -> bool:
        return kind in HOLDERS and holder(self.alone, kind, index) == 0

    def _body(self, kind: str, index: int) -> int:
        return index if kind == "body" else holder(self.alone, kind, index)

    def _acted_on(self, kind: str, index: int) -> bool:
        if kind in ("body", "joint"):
            return self.coupling.acts_on(self._body(kind, index))
        return self.coupling.anywhere

    def _less_simple(self, kind: str, index: int) -> bool:
        """Return whether only one of the models uses MuJoCo's shortcut for bodies that slide in the world.

        The shortcut's inverse weights differ from those of the whole mass matrix.
        """
        if kind not in ("body", "joint"):
            return False
        body = self._body(kind, index)
        there = self.matching.ids["body"][body]
        return there >= 0 and int(self.alone.body_simple[body]) != int(self.composed.body_simple[there])

    def _has_no_direction(self, tendon: int) -> bool:
        """Return whether two neighbouring sites of a tendon lie in one point in the reference configuration.

        MuJoCo 4.0 then takes the x axis of the world for the direction between them, or that of a rounding error: what
        follows from it depends on how the part is turned.
        """
        model = self.alone
        first = int(model.tendon_adr[tendon])
        rows = range(first, first + int(model.tendon_num[tendon]))
        points = [
            self._reference(int(model.wrap_objid[row])) if int(model.wrap_type[row]) == WRAP_SITE else None
            for row in rows
        ]
        return any(
            one is not None and other is not None and np.allclose(one, other, rtol=0, atol=_ONE_POINT)
            for one, other in pairwise(points)
        )

    def _reference(self, site: int) -> tuple[float, ...]:
        """Return where a site of the part alone is in the reference configuration."""
        model = self.alone
        x, y, z = model.site_pos[site].tolist()
        pose, body = Pose((x, y, z)), int(model.site_bodyid[site])
        while body:
            (x, y, z), (w, a, b, c) = model.body_pos[body].tolist(), model.body_quat[body].tolist()
            pose, body = Pose((x, y, z), (w, a, b, c)) @ pose, int(model.body_parentid[body])
        return pose.pos

    def _runs(self, kind: str) -> list[Difference]:
        """Compare the data that elements point to."""
        found: list[Difference] = []
        for index, target in self.matching.pairs(kind):
            theirs = dict(runs(self.composed, kind, target))
            for name, mine in runs(self.alone, kind, index):
                other = theirs.get(name)
                if other is not None:
                    found += self._run(kind, name, index, target=target, mine=mine, other=other)
        return found

    def _run(
        self, kind: str, name: str, index: int, target: int, mine: Array, other: Array
    ) -> list[Difference]:
        if name in HULL and self._hull_for_others(kind, index):
            return []
        if mine.shape != other.shape:
            shown = self.matching.composed.describe(kind, target)
            return [Difference(kind, shown, f"{name}, rows", expected=len(mine), actual=len(other))]
        moved, bound = not self.coupling.in_place, self.tolerance
        if name == "actuator_acc0":
            on_tendon = int(self.alone.actuator_trntype[index]) == ON_TENDON
            tendon = int(self.alone.actuator_trnid[index, 0])
            if self._acted_on(kind, index) or (moved and on_tendon and self._has_no_direction(tendon)):
                return []
            bound = self._bound(Treatment.DERIVED)
        elif moved and name in IN_THE_WORLD:
            return []
        elif moved and name == "flex_vert":
            first = int(self.alone.flex_vertadr[index])
            # -1: nodes carry the vertex. `flex_vert0` says where it is between them, and this where the frame puts it.
            free = self.alone.flex_vertbodyid[first : first + len(mine)] > 0
            mine, other = mine[free], other[free]
        elif moved and name in FROM_THE_WORLD and mine.size:
            bound = max(bound, DERIVED_ROUNDING * max(1.0, float(np.abs(mine.astype(np.float64)).max())))
        elif name in ("actuator_length0", "actuator_lengthrange"):
            bound = self._bound(Treatment.ROUNDED)
        different = unequal(mine, other, bound)
        if not different.any():
            return []
        return [self._difference(kind, target, name, expected=mine, actual=other, different=different)]

    def _sleep(self) -> list[Difference]:
        """Compare the sleep policy of a kinematic tree, if the part's author wrote one on its root."""
        found: list[Difference] = []
        if not hasattr(self.alone, "tree_sleep_policy"):
            return found
        for index, target in self.matching.pairs("body"):
            if self.alone.body_rootid[index] != index or self.composed.body_rootid[target] != target:
                continue
            mine, theirs = int(self.alone.body_treeid[index]), int(self.composed.body_treeid[target])
            if mine < 0 or theirs < 0:
                continue
            expected = int(self.alone.tree_sleep_policy[mine])
            actual = int(self.composed.tree_sleep_policy[theirs])
            if expected >= AUTHORED_SLEEP and expected != actual:
                name = self.matching.composed.describe("body", target)
                found.append(Difference("body", name, "tree_sleep_policy", expected=expected, actual=actual))
        return found

    def _difference(
        self,
        kind: str,
        target: int,
        name: str,
        expected: Array,
        actual: Array,
        different: Array | None = None,
    ) -> Difference:
        a, b = np.asarray(expected), np.asarray(actual)
        shown = self.matching.composed.describe(kind, target)
        if a.size <= _SHOWN:
            return Difference(kind, shown, name, expected=_value(a), actual=_value(b))
        places = np.argwhere(unequal(a, b, self.tolerance) if different is None else different)
        first = tuple(places[0].tolist())
        return Difference(
            kind, shown, f"{name}{list(first)}", expected=a[first].item(), actual=b[first].item()
        )


def _value(array: Array) -> Value:
    return tuple(_value(item) for item in array) if array.ndim else array.item()


_CLOSE = 1e-6


def same_stiffness(alone: Model, composed: Model, joint: int, target: int) -> bool:
    """Return whether stiffness times inverse inertia, in 1/s², is the same; `springdamper` sets the stiffness by it."""
    mine = float(alone.jnt_stiffness[joint]) * _inverse_inertia(alone, joint)
    theirs = float(composed.jnt_stiffness[target]) * _inverse_inertia(composed, target)
    return math.isclose(mine, theirs, rel_tol=_CLOSE)


def same_damping(alone: Model, composed: Model, joint: int, target: int) -> bool:
    """Return whether damping times inverse inertia, in 1/s, is the same; `springdamper` sets the damping by it."""
    mine = float(alone.dof_damping[alone.jnt_dofadr[joint]]) * _inverse_inertia(alone, joint)
    theirs = float(composed.dof_damping[composed.jnt_dofadr[target]]) * _inverse_inertia(composed, target)
    return math.isclose(mine, theirs, rel_tol=_CLOSE)


def _inverse_inertia(model: Model, joint: int) -> float:
    return float(model.dof_invweight0[span(model, "qvel", joint)].mean())


def same_dampratio(alone: Model, composed: Model, actuator: int, target: int) -> bool:
    """Return whether a position servo has the same damping ratio in both models.

    Return False if the ratio is unknown. MuJoCo 4 takes the inertia from the inverse weight at the joint or tendon,
    MuJoCo 3 from the diagonal of the mass matrix; one match is enough.
    """
    if not (_is_damped_servo(alone, actuator) and _is_damped_servo(composed, target)):
        return False
    mine, theirs = alone.actuator_biasprm[actuator].tolist(), composed.actuator_biasprm[target].tolist()
    if mine[:2] != theirs[:2] or mine[3:] != theirs[3:]:
        return False
    return any(
        math.isclose(a, b, rel_tol=_CLOSE)
        for a, b in zip(_ratios(alone, actuator), _ratios(composed, target), strict=False)
        if a is not None and b is not None
    )


def _is_damped_servo(model: Model, actuator: int) -> bool:
    gains = servo(model, actuator) or {}
    return gains.get("kp", 0) > 0 and gains.get("kv", 0) > 0


def _ratios(model: Model, actuator: int) -> tuple[float | None, float | None]:
    """Return the damping ratio of a servo by the inverse weight and by the mass matrix, each None if unknown."""
    gains = servo(model, actuator) or {}
    stiffness, damping = gains["kp"], gains["kv"]
    output = rows_of(model, "actuator", "actuator_gear", index=actuator).start
    gear = float(model.actuator_gear[output, 0])
    kind, target = int(model.actuator_trntype[actuator]), int(model.actuator_trnid[actuator, 0])
    if gear == 0:
        return None, None
    if kind in ON_JOINTS:
        if int(model.jnt_type[target]) < SLIDE:
            return None, None
        dof = int(model.jnt_dofadr[target])
        light, heavy = float(model.dof_invweight0[dof]), float(model.dof_M0[dof])
    elif kind == ON_TENDON:
        light, heavy = float(model.tendon_invweight0[target]), _inertia_along(model, target)
    else:
        return None, None
    by_weight = damping * gear / (2 * math.sqrt(stiffness / light)) if light > 0 else None
    by_mass = damping * gear / (2 * math.sqrt(stiffness * heavy)) if heavy > 0 else None
    return by_weight, by_mass


def _inertia_along(model: Model, tendon: int) -> float:
    """Return the inertia that a fixed tendon moves; 0 for a spatial one, whose moments the model does not store."""
    first = int(model.tendon_adr[tendon])
    inertia = 0.0
    for at in range(first, first + int(model.tendon_num[tendon])):
        joint, coefficient = int(model.wrap_objid[at]), float(model.wrap_prm[at])
        if int(model.wrap_type[at]) != WRAP_JOINT or coefficient == 0:
            return 0.0
        inertia += float(model.dof_M0[model.jnt_dofadr[joint]]) / coefficient**2
    return inertia


__all__ = ["Difference", "Keys", "Mount", "Roots", "compare"]


def compare(
    alone: Model,
    composed: Model,
    *,
    prefix: str = "",
    hung_on: Mount | None = None,
    renamed: Mapping[str, Mapping[str, str]] | None = None,
    keys: Keys = Keys.MERGE,
    roots_in_keys: Roots = Roots.MOVED,
    others: Sequence[tuple[str, Model]] | None = None,
    ignore: Collection[str] = (),
    replaced_keys: Collection[str] = (),
    tolerance: float = 0.0,
    cut: bool = False,
) -> list[Difference]:
    """Return the differences between a part compiled alone and the same part in a composition.

    The result is empty if the part is unchanged. ``prefix`` includes its separator; the base's is empty.
    ``hung_on`` is the place of the part's world: the unmoved world by default. ``renamed`` maps names of the part
    to names in the composition, by kind, if they are not simply prefixed. ``ignore`` are arrays (`geom_friction`),
    or attributes of every kind (`friction`), that were changed on purpose; ``replaced_keys`` are keys of the
    composition that were written in place of the part's own. With ``others``, the prefixes and models of all other
    parts, elements with this part's prefix that belong to no part count as differences too.

    ``tolerance`` is relative to the larger of 1 and the value. 0 requires equality bit for bit wherever composition
    can preserve it; ``fields.RULES`` says where it cannot, and why. ``cut`` says that ``composed`` is the whole
    that the part was cut out of.

    Options, statistics and visual settings belong to the whole model and are not compared here. No I/O. Raises
    KeyError if ``hung_on`` names an unknown body.
    """
    mount = hung_on or Mount()
    matching = Correspondence(
        NameTable(alone), NameTable(composed), prefix=prefix, mount=mount, renamed=renamed or {}, cut=cut
    )
    coupling = Coupling(matching, mount, cut=cut)
    placing = Placing(matching, mount)
    found = presence_differences(matching, others)
    found += reference_differences(matching)
    found += Values(matching, coupling, placing, tolerance=tolerance).differences()
    if not coupling.in_place:
        found += placing.differences(tolerance)
    in_world = placing.transform if matching.mount == 0 else None
    found += key_differences(
        matching, in_world, keys, roots=roots_in_keys, tolerance=tolerance, replaced=replaced_keys
    )
    return [difference for difference in found if not _ignored(difference, ignore)]


def _ignored(difference: Difference, ignore: Collection[str]) -> bool:
    """Return whether ``ignore`` holds the array of the difference, or its name without the first word."""
    array = difference.array
    return array in ignore or array.partition("_")[2] in ignore
