"""Pairs of bodies that touch, and pairs that need not collide, in the child process that has MuJoCo."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import RowRange, counted

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

ADJACENT = "adjacent"
TOUCHING = "touching"
NEVER = "never"
_CLOSE = 1e-9
_NEAR = 0.002
_FAR = 10.0
"""Two bodies that come so near can touch: limits are soft, and a search takes steps."""
_STARTS = 3
_ROUNDS = 3
_STEPS = 7
_CURLS = 40
_MOST_POSES = 500_000
"""The number of poses of one search, a few seconds: a chain of N bodies has N² / 2 pairs with N / 3 joints each."""
_geoms, _joints = (RowRange(f"body_{of}adr", counted(f"body_{of}num")).rows for of in ("geom", "jnt"))

Pair = tuple[int, int]


def touching(mujoco: Any, model: MjModel, prefixes: list[str]) -> list[dict[str, Any]]:
    """Return the pairs of bodies of different parts that touch or overlap; runs under `mjcompose.mujoco.engine.call`.

    This checks the reference configuration and all keys. `prefixes` are the prefixes of the parts. Freely floating
    bodies are not checked, because they may lie on the other body. Each pair has the names of its `bodies` (empty for
    unnamed ones), their names for messages, and the place where they touch.
    """
    _let_collide(mujoco, model)
    explicit = {frozenset(map(int, pair)) for pair in zip(model.pair_geom1, model.pair_geom2, strict=True)}
    found: dict[Pair, dict[str, Any]] = {}
    for where, data in _keys(mujoco, model):
        for pair in _touched(mujoco, model, data, explicit=explicit):
            parts = {_part(model, body, prefixes) for body in pair}
            if len(parts) == 2 and pair not in found and not _floats(mujoco, model, pair):
                found[pair] = _in_words(model, pair) | {"where": where}
    return list(found.values())


def _part(model: MjModel, body: int, prefixes: list[str]) -> str:
    name = _named(model, body)
    return max((each for each in prefixes if name.startswith(each)), key=len, default="")


def _floats(mujoco: Any, model: MjModel, pair: Pair) -> bool:
    """Return whether only a free joint connects the two bodies."""
    roots = {int(model.body_rootid[body]) for body in pair}
    return len(roots) == 2 and any(_is_free(mujoco, model, root) for root in roots)


def _let_collide(mujoco: Any, model: MjModel) -> None:
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.opt.disableflags &= ~off


def _keys(mujoco: Any, model: MjModel) -> Iterator[tuple[str, Any]]:
    for key in range(-1, model.nkey):
        data = mujoco.MjData(model)
        if key >= 0:
            mujoco.mj_resetDataKeyframe(model, data, key)
        yield "the reference configuration" if key < 0 else f"the key `{model.key(key).name}`", data


def _in_words(model: MjModel, pair: Pair) -> dict[str, Any]:
    names = [model.body(body).name for body in pair]
    rows = zip(names, pair, strict=True)
    called = [f"`{name}`" if name else f"a body in `{_named(model, body)}`" for name, body in rows]
    return {"bodies": names, "called": called}


def _named(model: MjModel, body: int) -> str:
    return str(model.body(next((each for each in _chain(model, body) if model.body(each).name), 0)).name)


def needless(mujoco: Any, model: MjModel, asked: dict[str, int]) -> dict[str, Any]:
    """Return the pairs of bodies that MuJoCo checks unnecessarily; runs under `mjcompose.mujoco.engine.call`.

    A joint connects the two (`adjacent`), they touch in the reference configuration or in a key (`touching`), or they
    touch in none of the `samples`, which a `seed` draws (`never`): every joint is drawn from its range, and equalities
    are ignored. Bodies of the world itself are excluded, and a body that can move away from the other one without a
    limit never has the reason `never`. Nor do two bodies that actuators move on separate branches, such as the jaws of
    a gripper, or bodies that a search brings together: samples miss the pose in which they close. Jaws that touch in a
    key are also excluded, unless they touch in every sample. Each pair has the names of its `bodies`, their names for
    messages, `why` and `where`.
    """
    _let_collide(mujoco, model)
    branches = Branches(mujoco, model)
    rest = set(_checked(mujoco, model))
    reasons = dict.fromkeys(_jointed(mujoco, model, rest), (ADJACENT, ""))
    for pair, where in _touching_in_keys(mujoco, model, rest, branches=branches):
        reasons.setdefault(pair, (TOUCHING, where))
    jaws = {pair for pair in rest if branches.are_jaws(pair)}
    closed = {pair for pair, (why, _) in reasons.items() if why == TOUCHING and pair in jaws}
    left = {pair for pair in rest - jaws if pair not in reasons and branches.is_tied(pair, sliding=False)}
    apart = {pair for pair in left if branches.least_distance(pair) > _NEAR}
    left -= apart
    if left or closed:
        poses = _poses(mujoco, model, asked["samples"], seed=asked["seed"])
        left, always_closed = _sampled(mujoco, model, poses, apart=left, closed=closed)
        for pair in closed - always_closed:
            del reasons[pair]
    search = _Search(mujoco, model, asked["seed"], branches=branches)
    apart |= search.apart(left)
    reasons |= dict.fromkeys(apart, (NEVER, ""))
    pairs = [_in_words(model, pair) | {"why": why, "where": where} for pair, (why, where) in sorted(reasons.items())]
    return {"pairs": pairs, "unsearched": len(search.unsearched)}


def _jointed(mujoco: Any, model: MjModel, pairs: Collection[Pair]) -> Iterator[Pair]:
    """Yield the pairs of a body and its parent, without free bodies."""
    for one, other in sorted(pairs):
        if int(model.body_parentid[other]) == one and not _is_free(mujoco, model, other):
            yield one, other


def _touching_in_keys(
    mujoco: Any, model: MjModel, pairs: Collection[Pair], branches: Branches
) -> Iterator[tuple[Pair, str]]:
    """Yield the pairs that touch in the reference configuration or in a key, with its name."""
    for where, data in _keys(mujoco, model):
        for pair in sorted(_touched(mujoco, model, data).keys() & pairs):
            if branches.is_tied(pair, sliding=True):
                yield pair, where


def _sampled(
    mujoco: Any, model: MjModel, poses: Iterable[Any], apart: set[Pair], closed: set[Pair]
) -> tuple[set[Pair], set[Pair]]:
    """Return the pairs of `apart` that touch in none of the poses, and those of `closed` that touch in all of them."""
    for pose in poses:
        touched = _touched(mujoco, model, pose).keys()
        apart = apart - touched
        closed = closed & touched
        if not (apart or closed):
            break
    return apart, closed


class Branches:
    """Sums along the two branches of the tree that lead to a pair of bodies from the body that carries both.

    Every body adds its own values to its parent's sum, so the sum of a branch is a difference.
    """

    def __init__(self, mujoco: Any, model: MjModel) -> None:
        self.model = model
        self.carriers = _carriers(model.body_parentid)
        joints = mujoco.mjtJoint
        is_free = model.jnt_type == int(joints.mjJNT_FREE)
        is_endless_slide = (model.jnt_type == int(joints.mjJNT_SLIDE)) & (model.jnt_limited == 0)
        moved = np.isin(np.arange(model.njnt), list(_moved(mujoco, model)))
        self._loose = self._summed(self._of_joints(is_free) + (model.body_mocapid >= 0))
        self._endless = self._summed(self._of_joints(is_endless_slide))
        self._actuated = self._summed(self._of_joints(moved))
        self._reach = self._summed(self._steps(mujoco))
        self._radii = self._radii_of_geoms(mujoco)

    def is_tied(self, pair: Pair, *, sliding: bool) -> bool:
        """Return whether the two cannot move apart freely; `sliding` says that slides without a range do not count."""
        return not self._on_branches(self._loose, pair) and (sliding or not self._on_branches(self._endless, pair))

    def are_jaws(self, pair: Pair) -> bool:
        """Return whether neither body carries the other, and actuators move both relative to their carrier."""
        carrier = self.carriers[pair]
        return all(self._actuated[body] > self._actuated[carrier] for body in pair)

    def joints(self, pair: Pair) -> Iterator[int]:
        """Yield the joints that move one of two bodies against the other."""
        carrier = int(self.carriers[pair])
        for body in sorted(body for one in pair for body in _up_to(self.model, one, carrier)):
            yield from _joints(self.model, body)

    def least_distance(self, pair: Pair) -> float:
        """Return a distance (m) that the two bodies keep at least, whatever their joints do; negative if unknown.

        A body with hinges stays in a ball around the place that its first body has in the body that carries both.
        """
        carrier = int(self.carriers[pair])
        centers = []
        radius = 0.0
        for body in pair:
            radius += self._radii[body]
            first = self._first_on_branch(body, carrier)
            center = np.zeros(3) if first is None else self.model.body_pos[first]
            if first is not None:
                # The place of the first body is the center of the ball, and everything else adds to the radius.
                radius += self._reach[body] - self._reach[carrier] - np.linalg.norm(center)
            centers.append(center)
        return float(np.linalg.norm(centers[0] - centers[1]) - radius)

    def _first_on_branch(self, body: int, carrier: int) -> int | None:
        return next(
            (each for each in _up_to(self.model, body, carrier) if self.model.body_parentid[each] == carrier), None
        )

    def _on_branches(self, summed: np.ndarray, pair: Pair) -> float:
        """Return the sum of the values of the bodies on both branches."""
        one, other = pair
        return float(summed[one] + summed[other] - 2 * summed[self.carriers[pair]])

    def _summed(self, values: np.ndarray) -> np.ndarray:
        """Return the sum of the values of each body and of all bodies that carry it."""
        summed = np.array(values, dtype=float)
        for body, parent in enumerate(self.model.body_parentid.tolist()):
            if body:
                summed[body] += summed[parent]
        return summed

    def _of_joints(self, values: np.ndarray) -> np.ndarray:
        """Return the sum of the values of each body's joints."""
        weights = values.astype(float)
        return np.asarray(np.bincount(self.model.jnt_bodyid, weights=weights, minlength=self.model.nbody))

    def _steps(self, mujoco: Any) -> np.ndarray:
        """Return how far (m) each body can be from its parent, wherever its joints are."""
        model = self.model
        kinds = mujoco.mjtJoint
        # A turn about an anchor moves the frame of the body by at most twice its distance from the anchor.
        by_joint = 2 * np.linalg.norm(model.jnt_pos, axis=1)
        reference = model.qpos0[model.jnt_qposadr]
        strokes = np.abs(model.jnt_range - reference[:, None]).max(axis=1) if model.njnt else np.zeros(0)
        by_joint = np.where(model.jnt_type == int(kinds.mjJNT_SLIDE), strokes, by_joint)
        return np.asarray(np.linalg.norm(model.body_pos, axis=1) + self._of_joints(by_joint))

    def _radii_of_geoms(self, mujoco: Any) -> np.ndarray:
        """Return the radius (m) of a ball around each body's frame that contains its geoms."""
        model = self.model
        reaches = np.linalg.norm(model.geom_pos, axis=1) + model.geom_rbound
        reaches[model.geom_type == int(mujoco.mjtGeom.mjGEOM_PLANE)] = np.inf
        radii = np.zeros(model.nbody)
        np.maximum.at(radii, model.geom_bodyid, reaches)
        return radii


def _carriers(parents: np.ndarray) -> np.ndarray:
    """Return the body that carries each two bodies, or one of the two, shape (nbody, nbody)."""
    count = len(parents)
    carriers = np.zeros((count, count), dtype=int)
    for body in range(1, count):
        # Parents come before their children, so an earlier body is never below this one.
        carriers[body, :body] = carriers[parents[body], :body]
        carriers[:body, body] = carriers[body, :body]
        carriers[body, body] = body
    return carriers


def _up_to(model: MjModel, body: int, carrier: int) -> Iterator[int]:
    """Yield a body and the bodies that carry it, up to `carrier`, which is left out."""
    while body != carrier:
        yield body
        body = int(model.body_parentid[body])


def _checked(mujoco: Any, model: MjModel) -> Iterator[Pair]:
    """The pairs of bodies, without the world, whose geoms MuJoCo checks after the filters of `mj_collision`."""
    types = {
        body: [(int(model.geom_contype[geom]), int(model.geom_conaffinity[geom])) for geom in _geoms(model, body)]
        for body in range(1, model.nbody)
        if model.body_geomnum[body]
    }
    filters = _Filters(mujoco, model)
    for one, first in types.items():
        for other, second in types.items():
            if other <= one or filters.drop(one, other):
                continue
            if any(a & d or c & b for a, b in first for c, d in second):
                yield one, other


class _Filters:
    """The filters of `mj_collision` for two bodies, before their geoms count."""

    def __init__(self, mujoco: Any, model: MjModel) -> None:
        self._excluded = {int(signature) for signature in model.exclude_signature}
        self._are_parents_filtered = not int(model.opt.disableflags) & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
        self._welds = [int(weld) for weld in model.body_weldid]
        self._above = [self._welds[int(model.body_parentid[weld])] for weld in self._welds]

    def drop(self, one: int, other: int) -> bool:
        # The signature has the first body in its upper 16 bits.
        if (one << 16) + other in self._excluded or (other << 16) + one in self._excluded:
            return True
        weld = self._welds[one]
        other_weld = self._welds[other]
        if weld == other_weld:
            return True
        # MuJoCo never filters geoms that are welded to the world.
        if not (self._are_parents_filtered and weld and other_weld):
            return False
        return self._above[one] == other_weld or self._above[other] == weld


def _touched(mujoco: Any, model: MjModel, data: MjData, explicit: Collection[frozenset[int]] = ()) -> dict[Pair, None]:
    """Return the pairs of bodies that touch, except by two geoms that are an `explicit` pair."""
    # Without the constraints of `mj_fwdPosition`: many contacts at once would exceed MuJoCo's memory for them.
    for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_flex, mujoco.mj_collision):
        stage(model, data)
    found: dict[Pair, None] = {}
    for contact in data.contact:
        geoms = frozenset(int(each) for each in contact.geom)
        if contact.dist <= _CLOSE and min(geoms) >= 0 and geoms not in explicit:
            one, other = sorted(int(model.geom_bodyid[each]) for each in contact.geom)
            found[one, other] = None
    return found


def _moved(mujoco: Any, model: MjModel) -> set[int]:
    """Return the joints that actuators move, themselves or through equalities."""
    data = mujoco.MjData(model)
    mujoco.mj_fwdPosition(model, data)
    moved = {int(model.dof_jntid[dof]) for dof in data.moment_colind[: int(data.moment_rownnz.sum())]}
    coupled = list(_coupled(mujoco, model, data))
    for _ in coupled:
        for group in coupled:
            if group & moved:
                moved |= group
    return moved


def _coupled(mujoco: Any, model: MjModel, data: Any) -> Iterator[set[int]]:
    """Yield the joints that each equality couples."""
    kinds = mujoco.mjtEq
    for equality in range(model.neq):
        one = int(model.eq_obj1id[equality])
        other = int(model.eq_obj2id[equality])
        kind = int(model.eq_type[equality])
        if kind == int(kinds.mjEQ_JOINT) and other >= 0:
            yield {one, other}
        elif kind == int(kinds.mjEQ_TENDON) and other >= 0:
            owner = model if hasattr(model, "ten_J_rowadr") else data  # MuJoCo 3 has the Jacobian in the data
            rows = [slice(owner.ten_J_rowadr[n], owner.ten_J_rowadr[n] + owner.ten_J_rownnz[n]) for n in (one, other)]
            yield {int(model.dof_jntid[dof]) for row in rows for dof in owner.ten_J_colind.ravel()[row]}
        elif kind in (int(kinds.mjEQ_CONNECT), int(kinds.mjEQ_WELD)):
            if int(model.eq_objtype[equality]) == int(mujoco.mjtObj.mjOBJ_SITE):
                one = int(model.site_bodyid[one])
                other = int(model.site_bodyid[other])
            yield set(_between(model, (one, other)))


def _between(model: MjModel, pair: Pair) -> Iterator[int]:
    """Yield the joints that move one of two bodies against the other."""
    one, other = (set(_chain(model, body)) for body in pair)
    return (joint for body in sorted(one ^ other) for joint in _joints(model, body))


class _Search:
    """Brings pairs of bodies together by moving one joint at a time, in at most `_MOST_POSES` poses for all pairs.

    `unsearched` has the pairs for which there were no poses left.
    """

    def __init__(self, mujoco: Any, model: MjModel, seed: int, branches: Branches) -> None:
        self.mujoco = mujoco
        self.model = model
        self.branches = branches
        self.random = np.random.Generator(np.random.PCG64(seed))
        self.data = mujoco.MjData(model)
        self.poses_left = _MOST_POSES
        self.unsearched: set[Pair] = set()

    def apart(self, pairs: Collection[Pair]) -> set[Pair]:
        """Return the pairs that the search does not bring together."""
        left = set(pairs)
        if left:
            for pose in self._curled():
                left -= _touched(self.mujoco, self.model, pose).keys()
        apart = set()
        for pair in sorted(left):
            if pair not in left:
                continue
            if self.poses_left <= 0:
                self.unsearched.add(pair)
            elif self._least(pair) > _NEAR:
                apart.add(pair)
            else:
                # A pose that brings two bodies together often brings others together, too.
                left -= _touched(self.mujoco, self.model, self.data).keys() - apart
        return apart

    def _curled(self) -> Iterator[Any]:
        """Yield poses in which all joints go the same way, as the joints of a finger or a snake that curls."""
        joints = [joint for joint in range(self.model.njnt) if self._is_single(joint)]
        places = self.model.jnt_qposadr[joints]
        ends = np.array([_ends(self.model, joint) for joint in joints]).reshape(-1, 2)
        start = self.model.qpos0[places]
        for end in range(2):
            for share in np.linspace(0, 1, _CURLS + 1)[1:]:
                self.mujoco.mj_resetData(self.model, self.data)
                self.data.qpos[places] = start + share * (ends[:, end] - start)
                yield self.data

    def _is_single(self, joint: int) -> bool:
        return int(self.model.jnt_type[joint]) >= int(self.mujoco.mjtJoint.mjJNT_SLIDE)

    def _least(self, pair: Pair) -> float:
        """Return the smallest distance of two bodies (m) that the search finds; `data` has that pose."""
        self.mujoco.mj_resetData(self.model, self.data)
        geoms = self._colliding(pair)
        joints = [
            (int(self.model.jnt_qposadr[joint]), *_ends(self.model, joint))
            for joint in self.branches.joints(pair)
            if self._is_single(joint)
        ]
        best = _FAR
        for start in range(_STARTS):
            if start:
                for at, low, high in joints:
                    self.data.qpos[at] = low + self.random.random() * (high - low)
            best = min(best, self._descend(geoms, joints))
            if best <= _NEAR:
                break
        return best

    def _descend(self, geoms: Collection[Pair], joints: Collection[tuple[int, float, float]]) -> float:
        """Return the smallest distance (m) that moving one joint after the other finds from this pose."""
        nearest = self._distance(geoms)
        for _ in range(_ROUNDS):
            before = nearest
            for at, low, high in joints:
                place = self.data.qpos[at]
                for value in np.linspace(low, high, _STEPS):
                    self.data.qpos[at] = value
                    distance = self._distance(geoms)
                    if distance < nearest:
                        nearest = distance
                        place = value
                self.data.qpos[at] = place
                if nearest <= _NEAR:
                    return nearest
            if nearest >= before:
                break
        return nearest

    def _distance(self, geoms: Collection[Pair]) -> float:
        self.poses_left -= 1
        self.mujoco.mj_kinematics(self.model, self.data)
        return float(min(self.mujoco.mj_geomDistance(self.model, self.data, *pair, _FAR, None) for pair in geoms))

    def _colliding(self, pair: Pair) -> list[Pair]:
        types = self.model.geom_contype
        affinities = self.model.geom_conaffinity
        every = product(*(_geoms(self.model, body) for body in pair))
        return [(a, b) for a, b in every if types[a] & affinities[b] or types[b] & affinities[a]]


def _ends(model: MjModel, joint: int) -> tuple[float, float]:
    low, high = model.jnt_range[joint] if model.jnt_limited[joint] else (-np.pi, np.pi)
    return float(low), float(high)


def _is_free(mujoco: Any, model: MjModel, body: int) -> bool:
    return any(int(model.jnt_type[joint]) == int(mujoco.mjtJoint.mjJNT_FREE) for joint in _joints(model, body))


def _chain(model: MjModel, body: int) -> Iterator[int]:
    while body:
        yield body
        body = int(model.body_parentid[body])


def _poses(mujoco: Any, model: MjModel, count: int, seed: int) -> Iterator[Any]:
    random = np.random.Generator(np.random.PCG64(seed))
    data = mujoco.MjData(model)
    kinds = mujoco.mjtJoint
    for _ in range(count):
        for joint in range(model.njnt):
            type = int(model.jnt_type[joint])
            at = int(model.jnt_qposadr[joint])
            if type == int(kinds.mjJNT_BALL):
                turn = random.standard_normal(4)
                data.qpos[at : at + 4] = turn / np.linalg.norm(turn)
            elif type == int(kinds.mjJNT_HINGE) or (type == int(kinds.mjJNT_SLIDE) and model.jnt_limited[joint]):
                low, high = _ends(model, joint)
                data.qpos[at] = low + random.random() * (high - low)
        yield data
