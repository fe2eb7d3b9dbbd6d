"""Compare a part inside a composed model numerically with the part alone.

A part with a damping ratio gets another damping if something heavy is attached to it; it is unchanged as long as the
ratio is unchanged. The compiled model does not store the ratio, but it follows from the gain and the inertia in the
same model.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.rotation import Pose, multiply, rotate
from mjcompose.mujoco import arrays, match
from mjcompose.mujoco.addresses import RUNS, rows_of, span
from mjcompose.mujoco.arrays import DERIVED_ROUNDING, HULL, MEASURED, PLACED, ROUNDING, SLIDE, Treatment, about
from mjcompose.mujoco.attributes import HOLDERS, KINDS, NameTable, holder, name_table
from mjcompose.mujoco.compare import KeyMode, Pairs, Roots, Rules, Run, key_differences, plain_value, unequal_elements
from mjcompose.mujoco.controls import servo
from mjcompose.mujoco.match import ABSENT, Correspondence, Coupling, Difference, Mount, pose_of
from mjcompose.mujoco.references import ON_JOINTS, ON_TENDON, WRAP_JOINT, WRAP_SITE, Array, links, twists_a_rod
from mjcompose.mujoco.unequal import Bound, differing_rows

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_OF_FLEXES = "MuJoCo does not turn the axes of a flex's vertices with a frame"
_POSED = ("body", "geom", "site", "camera")


class Placing:
    """The rigid transform from the part's world to the frame of the mount's body: meters, and w x y z.

    ``transform`` is the mount's pose or, if that is unknown, the movement of the first root; None for a part with
    nothing at its root.
    """

    def __init__(self, matching: Correspondence, mount: Mount) -> None:
        self.matching = matching
        self.roots: dict[str, list[int]] = {kind: [] for kind in (*_POSED, "light")}
        alone = matching.alone.model
        for kind, roots in self.roots.items():
            at_root = getattr(alone, HOLDERS[kind]) == 0
            placed = (i for i, _ in matching.pairs(kind) if at_root[i])
            roots += [i for i in placed if kind != "body" or not twists_a_rod(alone, i)]
        self.transform = mount.pose if mount.pose is not None else self._first()

    def _first(self) -> Pose | None:
        for kind in _POSED:
            for index in self.roots[kind]:
                return self._there(kind, index) @ pose_of(self.matching.alone.model, kind, index).inverse()
        return None

    def _there(self, kind: str, index: int) -> Pose:
        """Return the pose of a root's counterpart in the frame of the mount, through bodies in between."""
        model = self.matching.composed.model
        target = self.matching.ids[kind][index]
        return self._frame(holder(model, kind, target)) @ pose_of(model, kind, target)

    def _frame(self, body: int) -> Pose:
        model = self.matching.composed.model
        pose = Pose()
        while body != self.matching.mount and body in self.matching.worlds:
            pose = pose_of(model, "body", body) @ pose
            body = int(model.body_parentid[body])
        return pose

    def seen_from(self, body: int) -> Pose:
        """Return the pose of the part's world in a body that holds it; the part's own pose if it is unknown."""
        return self._frame(body).inverse() @ (self.transform or Pose())

    def differences(self, tolerance: float = 0.0) -> list[Difference]:
        """Return the roots of a moved part that did not move with the other roots."""
        found: list[Difference] = []
        most = max(ROUNDING, tolerance)
        bound = Bound(most, absolute=most, floor=0.0)
        vertices = set(self.matching.alone.model.flex_vertbodyid.tolist())
        if self.transform is not None:
            for kind, roots in self.roots.items():
                for index in roots:
                    name = self.matching.composed.describe(kind, self.matching.ids[kind][index])
                    poses = self._light(index) if kind == "light" else self._posed(kind, index)
                    for field, expected, actual in poses:
                        turned = tuple(-x for x in actual) if field == "quat" else actual
                        if _near(expected, actual, bound) or _near(expected, turned, bound):
                            continue
                        why = _OF_FLEXES if field == "quat" and kind == "body" and index in vertices else ""
                        array = f"{KINDS[kind].arrays}_{field}"
                        found.append(Difference(kind, name, array, expected=expected, actual=actual, why=why))
        return found

    def _posed(self, kind: str, index: int) -> Iterator[tuple[str, tuple[float, ...], tuple[float, ...]]]:
        assert self.transform is not None
        expected = self.transform @ pose_of(self.matching.alone.model, kind, index)
        actual = self._there(kind, index)
        yield "pos", expected.pos, actual.pos
        yield "quat", expected.quat, actual.quat

    def _light(self, index: int) -> Iterator[tuple[str, tuple[float, ...], tuple[float, ...]]]:
        assert self.transform is not None
        alone = self.matching.alone.model
        composed = self.matching.composed.model
        target = self.matching.ids["light"][index]
        frame = self._frame(int(composed.light_bodyid[target]))
        mine = alone.light_pos[index].tolist()
        theirs = composed.light_pos[target].tolist()
        yield "pos", (self.transform @ Pose(mine)).pos, (frame @ Pose(theirs)).pos
        mine = alone.light_dir[index].tolist()
        theirs = composed.light_dir[target].tolist()
        yield "dir", rotate(self.transform.quat, mine), rotate(frame.quat, theirs)


_OF_MUSCLES = {"actuator_gainprm": "actuator_gaintype", "actuator_biasprm": "actuator_biastype"}
_MUSCLE = 2  # mjGAIN_MUSCLE, mjBIAS_MUSCLE
_FORCE = 2
_SCALE = 3
_LEAST = 1e-15  # mjMINVAL


def _with_force(alone: MjModel, composed: MjModel, array: str, pair: tuple[int, int]) -> Array:
    """Return the parameters of an actuator as they should be in the composition, for a muscle with its peak force.

    A negative force stands for `scale` / `acc0` in MuJoCo 4.0, which depends on the bodies around.
    """
    index, target = pair
    expected = np.array(getattr(alone, array)[index])
    actual = getattr(composed, array)[target]
    if int(getattr(alone, _OF_MUSCLES[array])[index]) != _MUSCLE or min(expected[_FORCE], actual[_FORCE]) >= 0:
        return expected
    before = _peak_force(alone, expected, index)
    after = _peak_force(composed, actual, target)
    expected[_FORCE] = actual[_FORCE] if math.isclose(before, after, rel_tol=_CLOSE) else before
    return expected


def _peak_force(model: MjModel, parameters: Array, actuator: int) -> float:
    if parameters[_FORCE] >= 0:
        return float(parameters[_FORCE])
    output = rows_of(model, "actuator", "actuator_acc0", index=actuator).start
    return float(parameters[_SCALE]) / max(float(model.actuator_acc0[output]), _LEAST)


def _near(expected: tuple[float, ...], actual: tuple[float, ...], bound: Bound) -> bool:
    return all(map(bound.allows, expected, actual))


_WELD = 1  # mjEQ_WELD
_ONE_POINT = 1e-9
"""Meters; at this distance the direction between two points consists of rounding errors."""
_SHOWN = 12
"""Longer rows are shown by their first differing entry."""


class InComposition(Rules):
    """The differences allowed between a part alone and in a composition, by the table of arrays."""

    def __init__(self, matching: Correspondence, coupling: Coupling, placing: Placing, tolerance: float) -> None:
        self.matching = matching
        self.coupling = coupling
        self.placing = placing
        self.tolerance = tolerance
        self.alone = matching.alone.model
        self.composed = matching.composed.model
        self.moved = not coupling.in_place

    def ignores(self, kind: str, array: str, index: int) -> bool:
        # Only for a mesh that something of the part collides with, MuJoCo computes a convex hull for the part.
        return kind == "mesh" and HULL in about(array).traits and int(self.alone.mesh_graphadr[index]) < 0

    def expected(self, array: str, pairs: Pairs, mine: Array, theirs: Array) -> Array:
        if array in _OF_MUSCLES:
            return np.array([_with_force(self.alone, self.composed, array, pair) for pair in pairs])
        if array != "eq_data" or not self.moved:
            return mine
        return np.array([self._moved(*pair, theirs[pair[1]]) for pair in pairs])

    def _moved(self, index: int, target: int, actual: Array) -> Array:
        """Return the numbers of an equality, with positions in the part's world moved to the part."""
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
            turn = multiply(pose.quat, (w, a, b, c)) if of_world[0] else multiply((w, a, b, c), pose.inverse().quat)
            data[6:10] = np.array(turn) * (1.0 if np.dot(turn, actual[6:10]) >= 0 else -1.0)
        return data

    def bound(self, treatment: Treatment) -> float:
        if treatment in (Treatment.ROUNDED, Treatment.GAIN) and self.moved:
            return max(ROUNDING, self.tolerance)
        if treatment is Treatment.DERIVED:
            return max(DERIVED_ROUNDING, self.tolerance)
        return self.tolerance

    def excuses(self, treatment: Treatment, kind: str, array: str, pair: tuple[int, int]) -> bool:
        index, target = pair
        coupling = self.coupling
        moved = self.moved
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
                seen_otherwise = self._acted_on(kind, index) or self._less_simple(kind, index)
                return seen_otherwise and same_by_inertia(self.alone, self.composed, index, target=target, array=array)
            case Treatment.ROUNDED:
                return moved and array == "flex_size"
            case _:
                return False

    def _at_root(self, kind: str, index: int) -> bool:
        return kind in HOLDERS and holder(self.alone, kind, index) == 0

    def _body(self, kind: str, index: int) -> int:
        return index if kind == "body" else holder(self.alone, kind, index)

    def _acted_on(self, kind: str, index: int) -> bool:
        if kind in ("body", "joint"):
            return self.coupling.acts_on(self._body(kind, index))
        return bool(self.coupling.trees)

    def _less_simple(self, kind: str, index: int) -> bool:
        """Return whether only one model uses MuJoCo's shortcut for sliding bodies, with other inverse weights."""
        if kind not in ("body", "joint"):
            return False
        body = self._body(kind, index)
        there = self.matching.ids["body"][body]
        return there >= 0 and int(self.alone.body_simple[body]) != int(self.composed.body_simple[there])

    def _has_no_direction(self, tendon: int) -> bool:
        """Return whether two sites of a tendon are one point: MuJoCo 4.0 takes the world's x axis as direction."""
        model = self.alone
        rows = RUNS["tendon"]["nwrap"].rows(self.alone, tendon)
        sites = [int(model.wrap_objid[row]) if int(model.wrap_type[row]) == WRAP_SITE else ABSENT for row in rows]
        pairs = (map(self._reference, pair) for pair in pairwise(sites) if min(pair) >= 0)
        return any(np.allclose(one, other, rtol=0, atol=_ONE_POINT) for one, other in pairs)

    def _reference(self, site: int) -> tuple[float, ...]:
        model = self.alone
        pose = pose_of(model, "site", site)
        body = int(model.site_bodyid[site])
        while body:
            pose = pose_of(model, "body", body) @ pose
            body = int(model.body_parentid[body])
        return pose.pos

    def run(self, kind: str, array: str, index: int, run: Run) -> tuple[*Run, float] | None:
        mine, other = run
        traits = about(array).traits
        bound = self.tolerance
        if array == "actuator_acc0":
            on_tendon = int(self.alone.actuator_trntype[index]) == ON_TENDON
            tendon = int(self.alone.actuator_trnid[index, 0])
            if self._acted_on(kind, index) or (self.moved and on_tendon and self._has_no_direction(tendon)):
                return None
            bound = self.bound(Treatment.DERIVED)
        elif self.moved and PLACED in traits:
            return None
        elif self.moved and array == "flex_vert":
            first = int(self.alone.flex_vertadr[index])
            # -1: nodes carry the vertex. `flex_vert0` says where it is between them, and this where the frame puts it.
            free = self.alone.flex_vertbodyid[first : first + len(mine)] > 0
            mine = mine[free]
            other = other[free]
        elif self.moved and MEASURED in traits and mine.size:
            bound = max(bound, DERIVED_ROUNDING * max(1.0, float(np.abs(mine.astype(np.float64)).max())))
        elif array in ("actuator_length0", "actuator_lengthrange"):
            bound = self.bound(Treatment.ROUNDED)
        return mine, other, bound


def _sleep(matching: Correspondence) -> list[Difference]:
    """Compare the sleep policy of a kinematic tree, if the part's author wrote one on its root."""
    found: list[Difference] = []
    alone = matching.alone.model
    composed = matching.composed.model
    if not hasattr(alone, "tree_sleep_policy"):
        return found
    for index, target in matching.pairs("body"):
        if alone.body_rootid[index] != index or composed.body_rootid[target] != target:
            continue
        mine = int(alone.body_treeid[index])
        theirs = int(composed.body_treeid[target])
        if mine < 0 or theirs < 0:
            continue
        expected = int(alone.tree_sleep_policy[mine])
        actual = int(composed.tree_sleep_policy[theirs])
        if expected >= arrays.AUTHORED_SLEEP and expected != actual:
            name = matching.composed.describe("body", target)
            found.append(Difference("body", name, "tree_sleep_policy", expected=expected, actual=actual))
    return found


def number_differences(matching: Correspondence, rules: Rules) -> list[Difference]:
    """Return the numbers of a part that differ in a composition; a long row is shown by its first differing number."""
    found: list[Difference] = []
    for each in unequal_elements(matching, rules):
        name = matching.composed.describe(each.kind, each.target)
        field = each.array
        if each.different is None:
            rows = len(each.expected), len(each.actual)
            found.append(Difference(each.kind, name, f"{field}, rows", expected=rows[0], actual=rows[1]))
            continue
        several = field.startswith("dof_")  # a row for each degree of freedom
        rows_apart = differing_rows(each.different) if several else [...]
        for row in rows_apart:
            expected = each.expected[row]
            actual = each.actual[row]
            different = each.different[row]
            at: Any = tuple(np.argwhere(different)[0].tolist()) if different.size > _SHOWN else ...
            shown = field if at is ... else f"{field}{list(at)}"
            before = plain_value(expected[at])
            after = plain_value(actual[at])
            found.append(Difference(each.kind, name, shown, expected=before, actual=after))
    return [*dict.fromkeys(found), *_sleep(matching)]


_CLOSE = 1e-6


def same_by_inertia(alone: MjModel, composed: MjModel, joint: int, target: int, *, array: str) -> bool:
    """Return whether stiffness or damping times inverse inertia is the same; `springdamper` depends on it."""

    def ratio(model: MjModel, of: int) -> float:
        row = of if array == "jnt_stiffness" else model.jnt_dofadr[of]
        return float(getattr(model, array)[row]) * float(model.dof_invweight0[span(model, "qvel", of)].mean())

    return math.isclose(ratio(alone, joint), ratio(composed, target), rel_tol=_CLOSE)


def same_dampratio(alone: MjModel, composed: MjModel, actuator: int, target: int) -> bool:
    """Return whether a position servo has the same damping ratio in both models.

    Return False if the ratio is unknown. MuJoCo 4 takes the inertia from the inverse weight at the joint or tendon,
    MuJoCo 3 from the diagonal of the mass matrix; one match is enough.
    """
    if not (_is_damped_servo(alone, actuator) and _is_damped_servo(composed, target)):
        return False
    mine = alone.actuator_biasprm[actuator].tolist()
    theirs = composed.actuator_biasprm[target].tolist()
    if mine[:2] != theirs[:2] or mine[3:] != theirs[3:]:
        return False
    ratios = zip(_ratios(alone, actuator), _ratios(composed, target), strict=True)
    return any(a is not None and b is not None and math.isclose(a, b, rel_tol=_CLOSE) for a, b in ratios)


def _is_damped_servo(model: MjModel, actuator: int) -> bool:
    gains = servo(model, actuator) or {}
    return gains.get("kp", 0) > 0 and gains.get("kv", 0) > 0


def _ratios(model: MjModel, actuator: int) -> tuple[float | None, float | None]:
    """Return the damping ratio of a servo by the inverse weight and by the mass matrix; each is None if unknown."""
    gains = servo(model, actuator) or {}
    stiffness = gains["kp"]
    damping = gains["kv"]
    gear = float(model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=actuator).start, 0])
    kind = int(model.actuator_trntype[actuator])
    target = int(model.actuator_trnid[actuator, 0])
    light = heavy = 0.0
    if kind == ON_TENDON:
        light = float(model.tendon_invweight0[target])
        heavy = _inertia_along(model, target)
    elif kind in ON_JOINTS and int(model.jnt_type[target]) >= SLIDE:
        dof = int(model.jnt_dofadr[target])
        light = float(model.dof_invweight0[dof])
        heavy = float(model.dof_M0[dof])
    by_weight = damping * gear / (2 * math.sqrt(stiffness / light)) if gear and light > 0 else None
    by_mass = damping * gear / (2 * math.sqrt(stiffness * heavy)) if gear and heavy > 0 else None
    return by_weight, by_mass


def _inertia_along(model: MjModel, tendon: int) -> float:
    """Return the inertia that a fixed tendon moves; 0 for a spatial tendon, whose moments the model does not store."""
    inertia = 0.0
    for at in RUNS["tendon"]["nwrap"].rows(model, tendon):
        joint = int(model.wrap_objid[at])
        coefficient = float(model.wrap_prm[at])
        if int(model.wrap_type[at]) != WRAP_JOINT or coefficient == 0:
            return 0.0
        inertia += float(model.dof_M0[model.jnt_dofadr[joint]]) / coefficient**2
    return inertia


def compare(
    alone: MjModel,
    composed: MjModel,
    *,
    prefix: str = "",
    hung_on: Mount | None = None,
    renamed: Mapping[str, Mapping[str, str]] | None = None,
    keys: KeyMode = KeyMode.MERGE,
    roots_in_keys: Roots = Roots.MOVED,
    others: Sequence[tuple[str, MjModel]] | None = None,
    ignore: Collection[str] = (),
    replaced_keys: Collection[str] = (),
    tolerance: float = 0.0,
    cut: bool = False,
) -> list[Difference]:
    """Return the differences between a part compiled alone and the same part in a composition.

    The result is empty if the part is unchanged. ``prefix`` includes its separator. The prefix of the base is empty.
    ``hung_on`` is the place of the part's world: the unmoved world by default. ``renamed`` maps names of the part
    to names in the composition, by kind, if they are not simply prefixed. ``ignore`` are arrays (`geom_friction`),
    or attributes of every kind (`friction`), that were changed on purpose; ``replaced_keys`` are keys of the
    composition that replace the part's own. With ``others``, the prefixes and models of all other
    parts, elements with this part's prefix that belong to no part count as differences too.

    ``tolerance`` is relative to the larger of 1 and the value. 0 requires equality bit for bit wherever composition can
    preserve it; the table of arrays has the exceptions and their reasons. ``cut`` says that ``composed`` is the whole
    that the part was cut out of.

    Options, statistics and visual settings belong to the whole model and are not compared here. No I/O. Raises
    KeyError if ``hung_on`` names an unknown body.
    """
    mount = hung_on or Mount()
    matching = Correspondence(
        NameTable(alone), name_table(composed), prefix=prefix, mount=mount, renamed=renamed or {}, cut=cut
    )
    coupling = Coupling(matching, mount, cut=cut)
    placing = Placing(matching, mount)
    found = match.presence_differences(matching, others)
    found += match.reference_differences(matching)
    found += number_differences(matching, InComposition(matching, coupling, placing, tolerance=tolerance))
    if not coupling.in_place:
        found += placing.differences(tolerance)
    in_world = placing.transform if matching.mount == 0 else None
    found += key_differences(matching, in_world, keys, roots=roots_in_keys, tolerance=tolerance, replaced=replaced_keys)
    return [each for each in found if each.array not in ignore and each.array.partition("_")[2] not in ignore]
