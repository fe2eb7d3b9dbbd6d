"""The oracle: a part does in a composition what MuJoCo makes it do alone, element by element, by name.

It shares no code with `verify` and the check `unchanged`, and reads nothing but `mjModel` and `mjData`. The part alone
gets the gravity of the place, in the frame of the place, and the rest of the composition stands still, in a random
pose. Then these must agree: masses, inertias, poses, velocities, bias, passive and actuator forces, the mass matrix,
lengths of tendons, residuals of equalities, sensors, contacts within the part, flexes, skins, height fields, meshes,
plugins, custom data, and the numbers of keys.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from fidelity.random_parts import Attached, Case
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.cache.cells import cells_of
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context
from numpy.typing import NDArray

Array = NDArray[np.float64]
STATES = 2
CLOSE = 1e-8
FREE = int(mujoco.mjtJoint.mjJNT_FREE)
BALL = int(mujoco.mjtJoint.mjJNT_BALL)
_OBJECTS = {
    "geom": mujoco.mjtObj.mjOBJ_GEOM,
    "site": mujoco.mjtObj.mjOBJ_SITE,
    "tendon": mujoco.mjtObj.mjOBJ_TENDON,
    "actuator": mujoco.mjtObj.mjOBJ_ACTUATOR,
    "sensor": mujoco.mjtObj.mjOBJ_SENSOR,
    "equality": mujoco.mjtObj.mjOBJ_EQUALITY,
    "exclude": mujoco.mjtObj.mjOBJ_EXCLUDE,
    "pair": mujoco.mjtObj.mjOBJ_PAIR,
    "flex": mujoco.mjtObj.mjOBJ_FLEX,
    "skin": mujoco.mjtObj.mjOBJ_SKIN,
    "hfield": mujoco.mjtObj.mjOBJ_HFIELD,
    "mesh": mujoco.mjtObj.mjOBJ_MESH,
    "numeric": mujoco.mjtObj.mjOBJ_NUMERIC,
    "tuple": mujoco.mjtObj.mjOBJ_TUPLE,
    "plugin": mujoco.mjtObj.mjOBJ_PLUGIN,
}
_COUNTS = {"actuator": "nu", "tuple": "ntuple", "equality": "neq"}


@dataclass
class Frame:
    """A pose in the world: of the place of a part."""

    pos: Array
    rot: Array

    def point(self, points: Array) -> Array:
        return points @ self.rot.T + self.pos

    def turn(self, vectors: Array) -> Array:
        return vectors @ self.rot.T


def rotation(quat: Array) -> Array:
    found = np.zeros(9)
    mujoco.mju_quat2Mat(found, np.asarray(quat, dtype=float))
    return found.reshape(3, 3)


def quaternion(rot: Array) -> Array:
    found = np.zeros(4)
    mujoco.mju_mat2Quat(found, np.ascontiguousarray(rot).ravel())
    return found


def product(one: Array, other: Array) -> Array:
    found = np.zeros(4)
    mujoco.mju_mulQuat(found, one, other)
    return found


def composed(case: Case, folder: Path, session: Session) -> bytes | str:
    """Return the text of the model that a case builds, or the first error."""
    context = Context(environment={}, folder=folder)
    recipe = case.write(folder)
    given = {}
    name = None
    if case.cell is not None:
        cell = cells_of(recipe, context)[case.cell]
        given = cell.given
        name = cell.name
    built = build(ModelRequest(recipe, given, name=name, verified=False), context, session=session)
    return context.sink.errors[0].message if built is None else built.bundle.files[built.bundle.model]


def differences_in(case: Case, text: bytes, seed: int) -> list[str]:
    whole = mujoco.MjModel.from_xml_string(text.decode())
    found: list[str] = []
    for each in case.attached:
        alone = mujoco.MjModel.from_xml_string(case.files[each.source])
        found += Oracle(alone, whole, each, seed).differences()
    return found


_SHARED = ("mesh", "texture", "hfield")
"""The kinds of assets that the copies of a part share."""


class Oracle:
    """Compares one part alone with the same part in a composition."""

    def __init__(self, alone: mujoco.MjModel, whole: mujoco.MjModel, attached: Attached, seed: int) -> None:
        self.alone = alone
        self.whole = whole
        self.attached = attached
        self.prefix = attached.prefix
        self.random = np.random.default_rng(seed)
        self.found: list[str] = []
        self.ids = {kind: self._pairs(kind, object_type) for kind, object_type in _OBJECTS.items()}
        self.bodies = self._bodies()

    def differences(self) -> list[str]:
        if self.found:
            return self.found
        self._constants()
        self._joints()
        if self.found:
            return self.found
        for _ in range(STATES):
            self._state()
        self._keys()
        return self.found

    def expect(self, what: str, expected: Any, actual: Any, close: float = CLOSE) -> None:
        one = np.asarray(expected, dtype=float)
        other = np.asarray(actual, dtype=float)
        if one.shape != other.shape:
            self.found.append(f"{self.prefix}{what}: shape {other.shape}, alone {one.shape}")
            return
        if not one.size:
            return
        scale = max(1.0, float(np.abs(one).max()))
        if not np.abs(one - other).max() <= close * scale:
            self.found.append(f"{self.prefix}{what}: {other.ravel()[:6]}, alone {one.ravel()[:6]}")

    # Correspondence by name

    def _pairs(self, kind: str, object_type: mujoco.mjtObj) -> dict[int, int]:
        count = getattr(self.alone, _COUNTS.get(kind, f"n{kind}"))
        pairs: dict[int, int] = {}
        for index in range(count):
            name = mujoco.mj_id2name(self.alone, object_type, index) or ""
            prefix = self.attached.first if kind in _SHARED and self.attached.first else self.prefix
            other = mujoco.mj_name2id(self.whole, object_type, prefix + name) if name else -1
            if name and other < 0:
                self.found.append(f"the {kind} `{self.prefix}{name}` is missing")
            elif name:
                pairs[index] = other
        return pairs

    def _bodies(self) -> dict[int, int]:
        pairs: dict[int, int] = {}
        for index in range(1, self.alone.nbody):
            name = self.alone.body(index).name
            other = mujoco.mj_name2id(self.whole, mujoco.mjtObj.mjOBJ_BODY, self.prefix + name)
            if other < 0:
                self.found.append(f"the body `{self.prefix}{name}` is missing")
            else:
                pairs[index] = other
        return pairs

    def _addresses(self, positions: bool) -> tuple[list[int], list[int]]:
        """Return the addresses of the part's coordinates, alone and in the composition, body by body."""
        mine: list[int] = []
        theirs: list[int] = []
        for body, other in self.bodies.items():
            for at in range(int(self.alone.body_jntnum[body])):
                joint = int(self.alone.body_jntadr[body]) + at
                twin = int(self.whole.body_jntadr[other]) + at
                kind = int(self.alone.jnt_type[joint])
                width = {FREE: (7, 6), BALL: (4, 3)}.get(kind, (1, 1))[0 if positions else 1]
                addresses = "jnt_qposadr" if positions else "jnt_dofadr"
                mine += range(getattr(self.alone, addresses)[joint], getattr(self.alone, addresses)[joint] + width)
                theirs += range(getattr(self.whole, addresses)[twin], getattr(self.whole, addresses)[twin] + width)
        return mine, theirs

    # What does not move

    def _constants(self) -> None:
        for body, other in self.bodies.items():
            name = self.alone.body(body).name
            self.expect(f"mass of `{name}`", self.alone.body_mass[body], self.whole.body_mass[other])
            self.expect(f"center of `{name}`", self.alone.body_ipos[body], self.whole.body_ipos[other])
            tensors = [_tensor(model, at) for model, at in ((self.alone, body), (self.whole, other))]
            self.expect(f"inertia of `{name}`", *tensors)
            gravcomps = [model.body_gravcomp[at] for model, at in ((self.alone, body), (self.whole, other))]
            self.expect(f"gravity compensation of `{name}`", *gravcomps)
        self._arrays(
            "geom", "type size contype conaffinity condim friction solref solimp margin gap group priority rgba"
        )
        self._arrays("site", "type size rgba")
        self._arrays("tendon", "stiffness damping frictionloss lengthspring limited range")
        self._arrays(
            "actuator", "gear gainprm biasprm dynprm gaintype biastype dyntype ctrlrange ctrllimited lengthrange"
        )
        self._arrays("equality", "type active0 solref solimp")
        self._arrays("pair", "dim friction solref solimp margin gap")
        self._arrays("hfield", "size nrow ncol")
        self._arrays(
            "flex", "dim radius vertnum elemnum edgenum interp rigid contype conaffinity edgestiffness edgedamping"
        )
        self._runs("hfield", "hfield_data", "adr", lambda model, at: int(model.hfield_nrow[at] * model.hfield_ncol[at]))
        self._runs("mesh", "mesh_vert", "vertadr", lambda model, at: int(model.mesh_vertnum[at]))
        self._runs("skin", "skin_vert", "vertadr", lambda model, at: int(model.skin_vertnum[at]))
        self._runs("skin", "skin_face", "faceadr", lambda model, at: int(model.skin_facenum[at]))
        self._runs("skin", "skin_bonebindpos", "boneadr", lambda model, at: int(model.skin_bonenum[at]))
        self._runs("skin", "skin_bonebindquat", "boneadr", lambda model, at: int(model.skin_bonenum[at]))
        self._runs("flex", "flex_elem", "elemdataadr", lambda model, at: 3 * int(model.flex_elemnum[at]))
        self._runs("numeric", "numeric_data", "adr", lambda model, at: int(model.numeric_size[at]))
        self._runs("tuple", "tuple_objprm", "adr", lambda model, at: int(model.tuple_size[at]))
        self._runs("plugin", "plugin_attr", "attradr", lambda model, at: _texts_of_plugin(model, at))
        self._bones()
        self._tuples()
        self._excludes()

    def _arrays(self, kind: str, names: str) -> None:
        start = {"equality": "eq"}.get(kind, kind)
        for name in names.split():
            array = f"{start}_{name}"
            if not hasattr(self.alone, array):  # in another version
                continue
            for index, other in self.ids[kind].items():
                expected = getattr(self.alone, array)[index]
                actual = getattr(self.whole, array)[other]
                self.expect(f"`{array}` of {kind} {index}", expected, actual)

    def _runs(self, kind: str, array: str, address: str, count: Any) -> None:
        for index, other in self.ids[kind].items():
            rows = []
            for model, at in ((self.alone, index), (self.whole, other)):
                start = int(getattr(model, f"{kind}_{address}")[at])
                rows.append(np.array(getattr(model, array)[start : start + count(model, at)], dtype=float))
            self.expect(f"`{array}` of {kind} {index}", *rows)

    def _body_name(self, model: mujoco.MjModel, body: int, expected: bool) -> str:
        """Return the name in the composition of a body of the part; the world of sensors and tuples stays the world."""
        name = model.body(body).name
        return self.prefix + name if expected and body else name

    def _bones(self) -> None:
        for index, other in self.ids["skin"].items():
            names = []
            for model, at in ((self.alone, index), (self.whole, other)):
                start = int(model.skin_boneadr[at])
                count = int(model.skin_bonenum[at])
                bodies = model.skin_bonebodyid[start : start + count].tolist()
                names.append([self._body_name(model, body, model is self.alone) for body in bodies])
            if names[0] != names[1]:
                self.found.append(f"{self.prefix}bones of skin {index}: {names[1]}, not {names[0]}")

    def _tuples(self) -> None:
        for index, other in self.ids["tuple"].items():
            names = []
            for model, at in ((self.alone, index), (self.whole, other)):
                start = int(model.tuple_adr[at])
                count = int(model.tuple_size[at])
                bodies = model.tuple_objid[start : start + count].tolist()
                names.append([self._body_name(model, body, model is self.alone) for body in bodies])
            if names[0] != names[1]:
                self.found.append(f"{self.prefix}tuple {index}: {names[1]}, not {names[0]}")

    def _excludes(self) -> None:
        for index, other in self.ids["exclude"].items():
            names = []
            for model, at in ((self.alone, index), (self.whole, other)):
                signature = int(model.exclude_signature[at])
                pair = (signature >> 16, signature & 0xFFFF)
                names.append(sorted(self._body_name(model, body, model is self.alone) for body in pair))
            if names[0] != names[1]:
                self.found.append(f"{self.prefix}exclude {index}: {names[1]}, not {names[0]}")

    def _joints(self) -> None:
        for body, other in self.bodies.items():
            mine, theirs = (int(m.body_jntnum[at]) for m, at in ((self.alone, body), (self.whole, other)))
            if mine != theirs:
                self.found.append(f"{self.prefix}{self.alone.body(body).name} has {theirs} joints, alone {mine}")
                continue
            for at in range(mine):
                joint = int(self.alone.body_jntadr[body]) + at
                twin = int(self.whole.body_jntadr[other]) + at
                name = self.alone.joint(joint).name
                if name and self.whole.joint(twin).name != self.prefix + name:
                    self.found.append(f"{self.prefix}{name}: joint {at} of its body is `{self.whole.joint(twin).name}`")
                for array in ("type", "axis", "pos", "limited", "range", "stiffness", "margin", "solref", "solimp"):
                    values = [getattr(m, f"jnt_{array}")[j] for m, j in ((self.alone, joint), (self.whole, twin))]
                    self.expect(f"`jnt_{array}` of `{name}`", *values)
        for array in ("dof_armature", "dof_damping", "dof_frictionloss"):
            mine_, theirs_ = self._addresses(positions=False)
            self.expect(f"`{array}`", getattr(self.alone, array)[mine_], getattr(self.whole, array)[theirs_])

    # What moves

    def _state(self) -> None:
        """Compare both at one random state: the part moves, and the place stands still in a random pose."""
        mine = mujoco.MjData(self.alone)
        theirs = mujoco.MjData(self.whole)
        self._pose_others(theirs)
        mujoco.mj_kinematics(self.whole, theirs)
        frame = place_of(self.whole, theirs, self.attached)
        self._pose_part(mine, theirs, frame)
        self.alone.opt.gravity[:] = frame.rot.T @ self.whole.opt.gravity
        for model, data in ((self.alone, mine), (self.whole, theirs)):
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_sensorPos(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_sensorVel(model, data)
            mujoco.mj_fwdActuation(model, data)
        self._poses(mine, theirs, frame)
        self._forces(mine, theirs, frame)
        self._lengths(mine, theirs)
        self._residuals(mine, theirs)
        self._sensors(mine, theirs, frame)
        self._contacts(mine, theirs)

    def _pose_others(self, data: mujoco.MjData) -> None:
        data.qpos[:] = self.whole.qpos0
        for joint in range(self.whole.njnt):
            if self.whole.jnt_type[joint] not in (FREE, BALL):
                data.qpos[self.whole.jnt_qposadr[joint]] += self.random.uniform(-1, 1)

    def _pose_part(self, mine: mujoco.MjData, theirs: mujoco.MjData, frame: Frame) -> None:
        positions, twins = self._addresses(positions=True)
        velocities, other_velocities = self._addresses(positions=False)
        mine.qpos[:] = self.alone.qpos0 + self.random.uniform(-0.7, 0.7, self.alone.nq)
        mine.qvel[:] = self.random.uniform(-1, 1, self.alone.nv)
        mujoco.mj_normalizeQuat(self.alone, mine.qpos)
        theirs.qpos[twins] = mine.qpos[positions]
        theirs.qvel[other_velocities] = mine.qvel[velocities]
        for body, other in self.bodies.items():
            joint = int(self.alone.body_jntadr[body])
            twin = int(self.whole.body_jntadr[other])
            if self.alone.body_jntnum[body] and self.alone.jnt_type[joint] == FREE:
                at = int(self.alone.jnt_qposadr[joint])
                there = int(self.whole.jnt_qposadr[twin])
                theirs.qpos[there : there + 7] = moved(frame, mine.qpos[at : at + 7])
                at = int(self.alone.jnt_dofadr[joint])
                there = int(self.whole.jnt_dofadr[twin])
                theirs.qvel[there : there + 3] = frame.turn(mine.qvel[at : at + 3])
            mocap = int(self.alone.body_mocapid[body])
            other_mocap = int(self.whole.body_mocapid[other])
            if mocap >= 0:
                pose = moved(frame, np.concatenate([mine.mocap_pos[mocap], mine.mocap_quat[mocap]]))
                theirs.mocap_pos[other_mocap] = pose[:3]
                theirs.mocap_quat[other_mocap] = pose[3:]
        for actuator, other in self.ids["actuator"].items():
            mine.ctrl[actuator] = theirs.ctrl[other] = self.random.uniform(-1, 1)
            address = int(self.alone.actuator_actadr[actuator])
            there = int(self.whole.actuator_actadr[other])
            if address >= 0:
                mine.act[address] = theirs.act[there] = self.random.uniform(0, 1)

    def _poses(self, mine: mujoco.MjData, theirs: mujoco.MjData, frame: Frame) -> None:
        bodies = list(self.bodies)
        others = list(self.bodies.values())
        self.expect("positions of bodies", frame.point(mine.xpos[bodies]), theirs.xpos[others])
        self.expect("centers of mass", frame.point(mine.xipos[bodies]), theirs.xipos[others])
        turned = [frame.rot @ mine.xmat[body].reshape(3, 3) for body in bodies]
        self.expect("orientations of bodies", turned, [theirs.xmat[body].reshape(3, 3) for body in others])
        for kind in ("geom", "site"):
            ids = list(self.ids[kind])
            twins = list(self.ids[kind].values())
            places = getattr(mine, f"{kind}_xpos")
            there = getattr(theirs, f"{kind}_xpos")
            self.expect(f"positions of {kind}s", frame.point(places[ids]), there[twins])
            mats = getattr(mine, f"{kind}_xmat")
            other_mats = getattr(theirs, f"{kind}_xmat")
            turned = [frame.rot @ mats[at].reshape(3, 3) for at in ids]
            self.expect(f"orientations of {kind}s", turned, [other_mats[at].reshape(3, 3) for at in twins])
        for index, other in self.ids["flex"].items():
            points = []
            for model, data, at in ((self.alone, mine, index), (self.whole, theirs, other)):
                start = int(model.flex_vertadr[at])
                count = int(model.flex_vertnum[at])
                points.append(data.flexvert_xpos[start : start + count])
            self.expect(f"vertices of flex {index}", frame.point(points[0]), points[1])

    def _forces(self, mine: mujoco.MjData, theirs: mujoco.MjData, frame: Frame) -> None:
        dofs, others = self._addresses(positions=False)
        turn = self._turn_of_dofs(frame)
        for name in ("qfrc_bias", "qfrc_passive", "qfrc_actuator"):
            self.expect(f"`{name}`", turn @ getattr(mine, name)[dofs], getattr(theirs, name)[others])
        matrices = []
        for model, data in ((self.alone, mine), (self.whole, theirs)):
            full = np.zeros((model.nv, model.nv))
            mujoco.mj_fullM(*((model, full, data.qM) if hasattr(data, "qM") else (model, data, full)))
            matrices.append(full)
        self.expect("mass matrix", turn @ matrices[0][np.ix_(dofs, dofs)] @ turn.T, matrices[1][np.ix_(others, others)])
        actuators = list(self.ids["actuator"])
        twins = list(self.ids["actuator"].values())
        self.expect("forces of actuators", mine.actuator_force[actuators], theirs.actuator_force[twins])
        if mujoco.mj_versionString().startswith("3."):  # there, a length relative to a site depends on the world's axes
            actuators = [at for at in actuators if self.alone.actuator_trntype[at] != mujoco.mjtTrn.mjTRN_SITE]
            twins = [self.ids["actuator"][at] for at in actuators]
        self.expect("lengths of actuators", mine.actuator_length[actuators], theirs.actuator_length[twins])

    def _turn_of_dofs(self, frame: Frame) -> Array:
        """Return the matrix that turns the linear coordinates of free joints into the frame of the composition."""
        dofs, _ = self._addresses(positions=False)
        turn = np.eye(len(dofs))
        for joint in range(self.alone.njnt):
            if self.alone.jnt_type[joint] == FREE:
                at = dofs.index(int(self.alone.jnt_dofadr[joint]))
                turn[at : at + 3, at : at + 3] = frame.rot
        return turn

    def _lengths(self, mine: mujoco.MjData, theirs: mujoco.MjData) -> None:
        tendons = list(self.ids["tendon"])
        others = list(self.ids["tendon"].values())
        self.expect("lengths of tendons", mine.ten_length[tendons], theirs.ten_length[others])
        self.expect("velocities of tendons", mine.ten_velocity[tendons], theirs.ten_velocity[others])

    def _residuals(self, mine: mujoco.MjData, theirs: mujoco.MjData) -> None:
        for index, other in self.ids["equality"].items():
            rows = [_residual(data, at) for data, at in ((mine, index), (theirs, other))]
            if all(rows):  # MuJoCo omits the rows of an equality that moves nothing
                self.expect(f"residual of equality {index}", *rows)

    def _sensors(self, mine: mujoco.MjData, theirs: mujoco.MjData, frame: Frame) -> None:
        for index, other in self.ids["sensor"].items():
            values = []
            for model, data, at in ((self.alone, mine, index), (self.whole, theirs, other)):
                start = int(model.sensor_adr[at])
                width = int(model.sensor_dim[at])
                values.append(data.sensordata[start : start + width])
            expected = seen_from_world(self.alone, index, values[0], frame)
            kind = mujoco.mjtSensor(int(self.alone.sensor_type[index])).name
            if kind.endswith("QUAT"):
                expected = expected * np.sign(expected @ values[1])
            # MuJoCo finds the distance of two curved shapes by iterations.
            self.expect(f"{kind} {index}", expected, values[1], close=1e-3 if "GEOMDIST" in kind else CLOSE)

    def _contacts(self, mine: mujoco.MjData, theirs: mujoco.MjData) -> None:
        """Compare the pairs of bodies that touch, without bodies at the part's root and the geoms of its world.

        MuJoCo lets geoms of the world touch the bodies on it, and lets no body touch the bodies on it.
        """
        expected = set(_touching(self.alone, mine, ""))
        actual = set(_touching(self.whole, theirs, self.prefix))
        if self.attached.kind == "world" and expected ^ actual:
            self.found.append(f"{self.prefix}contacts: {sorted(actual)}, alone {sorted(expected)}")

    def _keys(self) -> None:
        if not self.alone.nkey:
            return
        mine = self.alone.key(0)
        try:
            theirs = self.whole.key(self.attached.key)
        except KeyError:
            self.found.append(f"the key `{self.attached.key}` is missing")
            return
        data = mujoco.MjData(self.whole)
        mujoco.mj_kinematics(self.whole, data)
        frame = place_of(self.whole, data, self.attached)
        for body, other in self.bodies.items():
            for at in range(int(self.alone.body_jntnum[body])):
                joint = int(self.alone.body_jntadr[body]) + at
                twin = int(self.whole.body_jntadr[other]) + at
                width = {FREE: 7, BALL: 4}.get(int(self.alone.jnt_type[joint]), 1)
                start = int(self.alone.jnt_qposadr[joint])
                there = int(self.whole.jnt_qposadr[twin])
                expected = mine.qpos[start : start + width]
                if width == 7:
                    expected = moved(frame, expected)
                self.expect(f"key of joint {joint}", *_alike(expected, theirs.qpos[there : there + width]))
            mocap = int(self.alone.body_mocapid[body])
            other_mocap = int(self.whole.body_mocapid[other])
            if mocap >= 0:
                pose = np.concatenate([mine.mpos.reshape(-1, 3)[mocap], mine.mquat.reshape(-1, 4)[mocap]])
                found = np.concatenate(
                    [theirs.mpos.reshape(-1, 3)[other_mocap], theirs.mquat.reshape(-1, 4)[other_mocap]]
                )
                self.expect(f"key of mocap body {body}", *_alike(moved(frame, pose), found))
        for actuator, other in self.ids["actuator"].items():
            self.expect(f"key of actuator {actuator}", mine.ctrl[actuator], theirs.ctrl[other])
            address = int(self.alone.actuator_actadr[actuator])
            there = int(self.whole.actuator_actadr[other])
            if address >= 0:
                self.expect(f"activation of actuator {actuator} in the key", mine.act[address], theirs.act[there])


def place_of(model: mujoco.MjModel, data: mujoco.MjData, attached: Attached) -> Frame:
    """Return the pose of a part's place, from the recipe and the element that it names."""
    if attached.kind == "joint":
        body = data.body(attached.prefix)
        return Frame(body.xpos.copy(), body.xmat.reshape(3, 3).copy())
    quat = np.zeros(4)
    mujoco.mju_euler2Quat(quat, np.array(attached.euler), "xyz")
    inner = Frame(np.array(attached.pos), rotation(quat))
    if attached.kind == "world":
        return inner
    holder = data.site(attached.name) if attached.kind == "site" else data.body(attached.name)
    rot = holder.xmat.reshape(3, 3)
    return Frame(holder.xpos + rot @ inner.pos, rot @ inner.rot)


def moved(frame: Frame, pose: Array) -> Array:
    """Return a pose, of three and four numbers, of the part alone as it is in the composition."""
    quat = pose[3:] / np.linalg.norm(pose[3:])
    return np.concatenate([frame.point(pose[:3]), product(quaternion(frame.rot), quat)])


def _alike(expected: Array, actual: Array) -> tuple[Array, Array]:
    """Return two rows of a key with unit quaternions of one sign."""
    rows = []
    for row in (expected, actual):
        row = np.array(row)
        if len(row) >= 4:
            row[-4:] /= np.linalg.norm(row[-4:])
            row[-4:] *= np.sign(row[-4:] @ np.array(actual)[-4:]) or 1.0
        rows.append(row)
    return rows[0], rows[1]


def _tensor(model: mujoco.MjModel, body: int) -> Array:
    turn = rotation(model.body_iquat[body])
    return turn @ np.diag(model.body_inertia[body]) @ turn.T


def _texts_of_plugin(model: mujoco.MjModel, index: int) -> int:
    ends = [int(each) for each in model.plugin_attradr if each > model.plugin_attradr[index]]
    return min([*ends, int(model.npluginattr)]) - int(model.plugin_attradr[index])


def _residual(data: mujoco.MjData, equality: int) -> list[float]:
    rows = (data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)) & (data.efc_id == equality)
    values = data.efc_pos[rows]
    # The residuals of a `connect` and a `weld` are vectors in the world.
    return (
        [float(np.linalg.norm(values[at : at + 3])) for at in range(0, len(values), 3)]
        if len(values) > 2
        else list(values)
    )


def _touching(model: mujoco.MjModel, data: mujoco.MjData, prefix: str) -> Iterator[tuple[str, str]]:
    for at in range(data.ncon):
        geoms = [int(each) for each in data.contact[at].geom if each >= 0]
        bodies = [int(model.geom_bodyid[geom]) for geom in geoms]
        names = [model.geom(geom).name for geom in geoms]
        if len(geoms) == 2 and all(bodies) and all(name.startswith(prefix) for name in names):
            first, second = sorted(name.removeprefix(prefix) for name in names)
            yield first, second


_OF_BODIES = (int(mujoco.mjtObj.mjOBJ_BODY), int(mujoco.mjtObj.mjOBJ_XBODY))
_POINTS = ("FRAMEPOS", "SUBTREECOM")
_VECTORS = ("FRAMEXAXIS", "FRAMELINVEL", "FRAMEANGVEL")


def seen_from_world(model: mujoco.MjModel, sensor: int, value: Array, frame: Frame) -> Array:
    """Return the value of a sensor of the part as it reads in the composition, if it reads in the world's frame."""
    kind = mujoco.mjtSensor(int(model.sensor_type[sensor])).name.removeprefix("mjSENS_")
    in_world = int(model.sensor_reftype[sensor]) in _OF_BODIES and int(model.sensor_refid[sensor]) == 0
    if int(model.sensor_refid[sensor]) >= 0 and not in_world:
        return value
    if kind in _POINTS:
        return frame.point(value)
    if kind in _VECTORS:
        return frame.turn(value)
    return product(quaternion(frame.rot), value) if kind == "FRAMEQUAT" else value
