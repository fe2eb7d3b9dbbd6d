"""Random places for copies on a surface, without overlap, in the child process that has MuJoCo.

Random numbers come from `draw_stream`, and all numbers are rounded before MuJoCo checks them, so machines whose results
differ in the last bits find the same places.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.draw_stream import bits, fraction
from mjcompose.base.rotation import IDENTITY_QUAT, Pose, Quat, multiply, normalize
from mjcompose.mujoco.addresses import numbers_of
from mjcompose.mujoco.attributes import names
from mjcompose.mujoco.controls import Divergence, steps_in

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_TRIES = 600
"""The tries for each copy."""
_ROUNDS = 6
"""How often to begin again if a copy finds no place."""
_DEPTH = 1e-5
"""How deep a copy may be in the surface that it lies on, in meters."""
_UP = 4e-7
"""Heights are rounded up."""
_AT_REST = 0.05
"""The greatest speed of a settled copy, in m/s or rad/s."""
_STILL = (1e-3, 0.02)
"""A copy that settling moves less than this, in meters and radians, stays where it was put."""
_RING = [[math.cos(n * math.pi / 8), math.sin(n * math.pi / 8), 0.0] for n in range(16)]
_DIRECTIONS = np.array([*_RING, [0.0, 0.0, -1.0]])
EDGE = "edge"
COPY = "copy"


def scatter(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    """Return the `poses` of the copies of each group in the world, and where their bodies `began`, or a `fault`.

    Runs under `mjcompose.mujoco.engine.call`. Each of the `groups` has `bodies`, a surface `over` by kind and name, a
    `place`, and the numbers of `language.attach.Scatter`. A fault has its `group`, its reason as `why`, and numbers.
    """
    option = model.opt
    off = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    before = int(option.disableflags), int(option.enableflags), float(option.o_margin)
    groups = [[int(model.body(name).id) for name in each["bodies"]] for each in asked["groups"]]
    scattering = _Scattering(mujoco, model, groups)
    poses = []
    for number, group in enumerate(asked["groups"]):
        option.disableflags = before[0] & ~off
        option.enableflags = before[1] | int(mujoco.mjtEnableBit.mjENBL_OVERRIDE)
        option.o_margin = group["clearance"] + _DEPTH
        fault = scattering.run(number, group)
        option.disableflags, option.enableflags, option.o_margin = before
        if fault is None and group["settle"]:
            fault = scattering.settle(number, group["settle"])
        if fault is not None:
            return {"fault": {"group": number, **fault}}
        poses.append([_listed(scattering.pose(body)) for body in scattering.groups[number]])
    began = [[_listed(scattering.pose(body, model.qpos0)) for body in each] for each in scattering.groups]
    return {"poses": poses, "began": began}


def _unknown(model: MjModel, group: dict[str, Any]) -> dict[str, Any] | None:
    """Return the fault of a group whose surface or keyframe does not exist, or None."""
    for kind, name in (group["over"], ("key", group["key"])):
        known = names(model, kind) if name is not None else []
        if name is not None and name not in known:
            noun = "keyframe" if kind == "key" else kind
            return {"why": "unknown", "kind": noun, "name": name, "known": list(filter(None, known))}
    return None


def _listed(pose: Pose) -> list[list[float]]:
    return [list(pose.pos), list(pose.quat)]


class _Scattering:
    """A model whose copies are free bodies, far away until they have a place."""

    def __init__(self, mujoco: Any, model: MjModel, groups: list[list[int]]) -> None:
        self.mujoco = mujoco
        self.model = model
        self.groups = groups
        self.data = mujoco.MjData(model)
        bodies = [body for group in groups for body in group]
        collides = (model.geom_contype != 0) | (model.geom_conaffinity != 0)
        roots = model.body_rootid[model.geom_bodyid]
        self.owner = np.where(np.isin(roots, bodies), roots, -1)
        self.geoms = {body: np.flatnonzero((self.owner == body) & collides) for body in bodies}
        self.blocked: Counter[str] = Counter()

    def _address(self, body: int) -> int:
        return int(self.model.jnt_qposadr[self.model.body_jntadr[body]])

    def pose(self, body: int, qpos: Any = None) -> Pose:
        """Return the pose of a copy in the world."""
        first = self._address(body)
        x, y, z, *quat = map(float, (self.data.qpos if qpos is None else qpos)[first : first + 7])
        return Pose((x, y, z), (quat[0], quat[1], quat[2], quat[3]))

    def _put(self, body: int, pose: Pose) -> None:
        first = self._address(body)
        self.data.qpos[first : first + 7] = [*pose.pos, *pose.quat]
        self.mujoco.mj_kinematics(self.model, self.data)

    def _park(self, bodies: Iterable[int], qpos: Any = None) -> None:
        for body in bodies:
            own = slice(self._address(body), self._address(body) + 7)
            self.data.qpos[own] = (self.model.qpos0 if qpos is None else qpos)[own]

    def run(self, number: int, group: dict[str, Any]) -> dict[str, Any] | None:
        """Give each copy of a group a place. Return the fault if that is impossible."""
        mujoco = self.mujoco
        model = self.model
        data = self.data
        bodies = self.groups[number]
        unknown = _unknown(model, group)
        if unknown is not None:
            return unknown
        before = data.qpos.copy()
        mujoco.mj_resetData(model, data)
        if group["key"] is not None:
            mujoco.mj_resetDataKeyframe(model, data, names(model, "key").index(group["key"]))
        self._park(chain(*self.groups), before)
        if group["key"] is not None and any(self._moves(*element) for element in (group["over"], group["place"])):
            return {"why": "moves"}
        if not self._can_collide(bodies[0]):
            return {"why": "untouchable"}
        mujoco.mj_kinematics(model, data)
        self.surface = _Surface(mujoco, model, data, *group["over"])
        if not self.surface.is_finite:
            return {"why": "endless"}
        best = 0
        self.blocked = Counter()
        for attempt in range(_ROUNDS):
            placed = self._placed(bodies, attempt, group)
            if placed == len(bodies):
                return None
            best = max(best, placed)
        return {"why": "room", "placed": best, "room": self.surface.room, "blocked": self.blocked.most_common()}

    def _can_collide(self, body: int) -> bool:
        """Return whether two copies of a body can touch."""
        geoms = self.geoms[body]
        types, affinities = (
            np.bitwise_or.reduce(bits[geoms], initial=0)
            for bits in (self.model.geom_contype, self.model.geom_conaffinity)
        )
        return bool(types & affinities)

    def _placed(self, bodies: list[int], attempt: int, group: dict[str, Any]) -> int:
        """Put the copies one after the other, and return how many found a place before the first that found none."""
        self._park(bodies)
        for count, body in enumerate(bodies):
            stream = f"{group['part']} {count} {attempt}"
            if not any(self._fits(body, trial, stream, group=group) for trial in range(_TRIES)):
                self._park([body])
                return count
        return len(bodies)

    def _moves(self, kind: str, name: str) -> bool:
        """Return whether a place or a surface is on a body that can move."""
        if kind in ("world", "body") and name in ("", "world"):
            return False
        element = getattr(self.model, kind)(name) if kind != "frame" else None
        return element is None or bool(self.model.body_weldid[element.id if kind == "body" else element.bodyid[0]])

    def _fits(self, body: int, trial: int, stream: str, group: dict[str, Any]) -> bool:
        """Put a copy at its next random pose, and return whether it has room there."""
        model = self.model
        data = self.data
        surface = self.surface
        drawn = (fraction(bits(group["seed"], trial, "scatter", element=stream, component=n)) for n in range(1000))
        low = surface.low
        high = surface.high
        x, y = (round(low[n] + next(drawn) * (high[n] - low[n]), 6) for n in range(2))
        quat = multiply(_turn(drawn, 2 if group["upright"] else 4), self.pose(body, model.qpos0).quat)
        pose = Pose((x, y, high[2] + 1.0), normalize(quat)).rounded()
        self._put(body, pose)
        found = [_support(model, data, int(geom)) for geom in self.geoms[body]]
        outline = np.stack(found)  # (geoms, directions, 3)
        points = [outline[at, n] for n, at in enumerate((outline * _DIRECTIONS).sum(axis=2).argmax(axis=0))]
        heights = [surface.height(float(point[0]), float(point[1])) for point in points]
        known = [height for height in heights if height is not None]
        if len(known) < len(heights):
            self.blocked[EDGE] += 1
            return False
        z = pose.pos[2] + max(known) - float(points[-1][2])
        for _ in range(8):  # down or up onto a surface that is not flat
            pose = Pose((x, y, round(z + _UP, 6)), pose.quat)
            self._put(body, pose)
            gap = surface.gap(self.geoms[body])
            depth, blocker = self._inside(body, group["clearance"])
            if depth > _DEPTH:
                z = pose.pos[2] + depth
            elif gap > 2 * _DEPTH:
                z = pose.pos[2] - gap
            else:
                break
        if depth > _DEPTH or blocker:
            self.blocked[blocker or EDGE] += 1
            return False
        return True

    def _inside(self, body: int, clearance: float) -> tuple[float, str]:
        """Return the depth of a copy in the surface, and the name of an element that is too close, or ""."""
        model = self.model
        data = self.data
        for stage in ("mj_comPos", "mj_flex", "mj_collision"):
            getattr(self.mujoco, stage)(model, data)
        depth = 0.0
        blocker = ""
        geoms = data.contact.geom
        distances = data.contact.dist
        owners = np.where(geoms >= 0, self.owner[geoms], -1)
        for n in np.flatnonzero((owners == body).any(axis=1)):
            other, owner = (int(each[n][1 if owners[n][0] == body else 0]) for each in (geoms, owners))
            if owner == body:
                continue
            is_surface = self.surface.kind == "geom" and other == self.surface.index
            around = other >= 0 and int(model.geom_bodyid[other]) == self.surface.body
            if is_surface:
                depth = max(depth, -float(distances[n]))
            elif distances[n] < (-_DEPTH if around else clearance - 1e-9):
                blocker = COPY if owner >= 0 else "flex" if other < 0 else _called(model, other)
        return depth, blocker

    def settle(self, number: int, seconds: float) -> dict[str, Any] | None:
        """Simulate the copies of a group until they rest, with all else fixed. Return the fault if they do not."""
        mujoco = self.mujoco
        model = self.model
        data = self.data
        bodies = self.groups[number]
        before = data.qpos.copy()
        time = data.time
        diverged = Divergence(mujoco, model, data)
        moving = [self._address(body) + n for body in bodies for n in range(7)]
        rates = [int(model.body_dofadr[body]) + n for body in bodies for n in range(6)]
        fixed = np.setdiff1d(np.arange(model.nq), moving)
        still = np.setdiff1d(np.arange(model.nv), rates)
        data.qvel[:] = 0
        for _ in range(steps_in(model, seconds)):
            mujoco.mj_step(model, data)
            if diverged:
                return {"why": "diverged"}
            data.qpos[fixed] = before[fixed]
            data.qvel[still] = 0
        speed = float(np.abs(data.qvel[rates]).max())
        data.qvel[:] = 0
        data.time = time
        for body in bodies:  # one that has only sunk or turned a little keeps its exact place
            start = self.pose(body, before)
            end = self.pose(body).rounded(5, 6)
            self._put(body, start if _are_near(start, end) else end)
        mujoco.mj_comPos(model, data)
        centers = [data.subtree_com[body] for body in bodies]
        floors = [self.surface.height(float(x), float(y)) for x, y, _ in centers]
        fallen = sum(int(floor is None or z < floor) for floor, (_, _, z) in zip(floors, centers, strict=True))
        if fallen:
            return {"why": "fell", "fallen": fallen}
        return {"why": "restless", "speed": speed} if speed > _AT_REST else None


class _Surface:
    """A geom or a site that copies lie on: its bounds in the world, and its height above the ground."""

    def __init__(self, mujoco: Any, model: MjModel, data: MjData, kind: str, name: str) -> None:
        self.mujoco = mujoco
        self.model = model
        self.data = data
        self.kind = kind
        element = getattr(model, kind)(name)
        there = getattr(data, kind)(name)
        self.index = int(element.id)
        self.body = int(element.bodyid[0])
        self.type = int(element.type[0])
        self.size = np.array(element.size, float)
        self.pos = there.xpos.copy()
        self.mat = there.xmat.copy()
        readers = {_MESH: mujoco.mj_rayMesh, _HFIELD: mujoco.mj_rayHfield}
        self.reader = readers.get(self.type) if kind == "geom" else None
        self.is_finite = self.type != _PLANE or bool((self.size[:2] > 0).all())
        self.measures = kind == "geom" and self.type != _HFIELD
        center = np.zeros(3)
        half = self.size.copy()
        radius = self.size[0]
        if self.type == _PLANE:
            half[2] = 0.0
        elif self.reader is not None:
            center = model.geom_aabb[self.index][:3]
            half = model.geom_aabb[self.index][3:]
        elif self.type == _SPHERE:
            half = np.full(3, radius)
        elif self.type in (_CAPSULE, _CYLINDER):
            half = np.array([radius, radius, self.size[1] + (radius if self.type == _CAPSULE else 0)])
        matrix = self.mat.reshape(3, 3)
        middle = self.pos + matrix @ center
        extent = np.abs(matrix) @ half
        self.low, self.high = ([round(float(each), 6) for each in ends] for ends in (middle - extent, middle + extent))
        self.room = [round(float(2 * each), 6) for each in half]
        if abs(matrix[2, 2]) < 0.5:  # another side of it is on top
            self.room = [high - low for low, high in zip(self.low, self.high, strict=True)]

    def height(self, x: float, y: float) -> float | None:
        """Return the height of the surface at a place, or None beyond its edge."""
        top = self.high[2] + 1.0
        start = np.array([x, y, top])
        down = np.array([0.0, 0.0, -1.0])
        if self.reader is not None:
            distance = self.reader(self.model, self.data, self.index, start, down)
        else:
            distance = self.mujoco.mju_rayGeom(self.pos, self.mat, self.size, start, down, self.type)
        return None if distance < 0 else top - float(distance)

    def gap(self, geoms: Any) -> float:
        """Return the distance of geoms to the surface; 0 if MuJoCo cannot measure it."""
        if not self.measures:
            return 0.0
        to_it = partial(self.mujoco.mj_geomDistance, self.model, self.data, geom2=self.index, distmax=1.0, fromto=None)
        return float(max(0.0, min(to_it(geom1=int(each)) for each in geoms)))


def _are_near(one: Pose, other: Pose) -> bool:
    chord = min(math.dist(one.quat, [sign * each for each in other.quat]) for sign in (1, -1))
    return math.dist(one.pos, other.pos) < _STILL[0] and 2 * chord < _STILL[1]


def _called(model: MjModel, geom: int) -> str:
    return str(model.geom(geom).name or model.body(int(model.geom_bodyid[geom])).name or "world")


def _support(model: MjModel, data: MjData, geom: int) -> Any:
    """Return the farthest point of a geom in each direction, `(directions, 3)`."""
    kind = int(model.geom_type[geom])
    size = model.geom_size[geom]
    matrix = data.geom_xmat[geom].reshape(3, 3)
    pos = data.geom_xpos[geom]
    local = _DIRECTIONS @ matrix
    sign = np.where(local >= 0, 1.0, -1.0)
    if kind == _MESH:
        vertices = numbers_of(model, "mesh", "mesh_vert", int(model.geom_dataid[geom])).astype(float)
        points = vertices[(vertices @ local.T).argmax(axis=0)]
    elif kind in (_SPHERE, _CAPSULE):
        points = local * size[0]
        points[:, 2] += sign[:, 2] * (size[1] if kind == _CAPSULE else 0.0)
    elif kind == _ELLIPSOID:
        points = size**2 * local / np.linalg.norm(size * local, axis=1, keepdims=True)
    elif kind == _CYLINDER:
        flat = np.linalg.norm(local[:, :2], axis=1, keepdims=True)
        points = np.hstack([local[:, :2] / np.maximum(flat, 1e-12) * size[0], sign[:, 2:] * size[1]])
    else:
        points = model.geom_aabb[geom][:3] + sign * model.geom_aabb[geom][3:]
    return pos + points @ matrix.T


# Values of `mjtGeom`.
_PLANE = 0
_HFIELD = 1
_SPHERE = 2
_CAPSULE = 3
_ELLIPSOID = 4
_CYLINDER = 5
_MESH = 7


def _turn(drawn: Any, count: int) -> Quat:
    """Return a random rotation: about the vertical from 2 numbers, or in any direction from 4 numbers."""
    while True:  # a point in the unit ball, whose direction is uniform
        point = [2.0 * next(drawn) - 1.0 for _ in range(count)]
        if 1e-6 < sum(each * each for each in point) <= 1.0:
            break
    w, x, y, z = point if count == 4 else (point[0], 0.0, 0.0, point[1])
    return normalize((w, x, y, z)) if (w, x, y, z) else IDENTITY_QUAT
