"""Keyframes of the mirror image of a model, in the child process that has MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import rows_of, span
from mjcompose.mujoco.arrays import BALL, FREE, HINGE
from mjcompose.mujoco.attributes import names

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

_NEAR = 1e-3
"""The allowed distance of a body from its mirror image, in meters; also the relative error of forces."""
_PARALLEL = 1e-6
_STEPS = ("names", "body", "axis", "range", "equality", "force")
"""The comparisons in their order. A later fault belongs to a better match."""


def mirrored_keys(mujoco: Any, asked: dict[str, Any]) -> dict[str, Any]:
    """Return the `keys` of a model's mirror image, by vector, or a `fault`. Runs under `mjcompose.mujoco.engine.call`.

    `texts` has the bare models of the original and of the image, and `axis` is the number of the axis across which they
    are symmetric. Elements correspond if they have the same name, or a name with left and right exchanged.
    """
    faults = []
    for exchange in (str, _exchanged):
        try:
            mirror = _Mirror(mujoco, asked["texts"], axis=asked["axis"], exchange=exchange)
            return {"keys": [mirror.key(number) for number in range(mirror.of.nkey)]}
        except _Unlike as unlike:
            faults.append(unlike.args[0])
    return {"fault": max(faults, key=lambda fault: _STEPS.index(fault["why"]))}


class _Unlike(Exception):
    """The two models are not mirror images, with the reason."""


def _exchanged(name: str) -> str:
    """Return a name with left and right exchanged.

    >>> _exchanged("left_arm/Right")
    'right_arm/Left'
    """
    for one, other in (("left", "right"), ("Left", "Right"), ("LEFT", "RIGHT")):
        name = other.join(part.replace(other, one) for part in name.split(one))
    return name


class _Mirror:
    def __init__(self, mujoco: Any, texts: Sequence[str], axis: int, exchange: Callable[[str], str]) -> None:
        self.exchange = exchange
        self.mujoco = mujoco
        self.flip = np.diag([-1.0 if each == axis else 1.0 for each in range(3)])
        self.of, self.own = (mujoco.MjModel.from_xml_string(text) for text in texts)
        self.data = [mujoco.MjData(model) for model in (self.of, self.own)]
        self.bodies, self.joints, self.actuators = (self._pairs(kind) for kind in ("body", "joint", "actuator"))
        for model, data in zip((self.of, self.own), self.data, strict=True):
            mujoco.mj_kinematics(model, data)
        self._compare_bodies(None)
        self.start = [(data.xpos.copy(), data.xmat.reshape(-1, 3, 3).copy(), data.xaxis.copy()) for data in self.data]
        self.turns = {joint: self._turn(joint, other) for joint, other in self.joints.items()}

    def _pairs(self, kind: str) -> dict[int, int]:
        ours = names(self.of, kind)
        theirs = names(self.own, kind)
        mirrored = [self.exchange(name) for name in ours]
        missing = sorted({*mirrored} ^ {*theirs})
        if missing:
            raise _Unlike({"why": "names", "kind": kind, "name": missing[0], "mine": missing[0] in theirs})
        return {index: theirs.index(name) for index, name in enumerate(mirrored)}

    def _compare_bodies(self, key: int | None) -> None:
        """Raise `_Unlike` if a body is not at the place of its counterpart's mirror image."""
        apart = {
            body: float(np.linalg.norm(self.flip @ self.data[0].xpos[body] - self.data[1].xpos[other]))
            for body, other in self.bodies.items()
        }
        worst = max(apart, key=apart.__getitem__)
        if apart[worst] > _NEAR:
            raise _Unlike({"why": "body", "key": key, "name": names(self.of, "body")[worst], "distance": apart[worst]})

    def _turn(self, joint: int, other: int) -> Any:
        """Return the matrix from the velocity of a joint to the velocity of its image."""
        kind = int(self.of.jnt_type[joint])
        mats = [
            start[1][model.jnt_bodyid[each]]
            for start, model, each in zip(self.start, (self.of, self.own), (joint, other), strict=True)
        ]
        if kind in (BALL, FREE) and kind == self.own.jnt_type[other]:
            turn = -(mats[1].T @ self.flip @ mats[0])
            return turn if kind == BALL else np.block([[self.flip, np.zeros((3, 3))], [np.zeros((3, 3)), turn]])
        image = self.flip @ self.start[0][2][joint] * (-1 if kind == HINGE else 1)
        along = float(image @ self.start[1][2][other])
        if kind != self.own.jnt_type[other] or abs(abs(along) - 1) > _PARALLEL:
            raise _Unlike({"why": "axis", "name": names(self.of, "joint")[joint]})
        sign = float(np.sign(along))
        if self._fits(joint, other, sign):
            return np.array([[sign]])
        # A pinion turns the other way round in the image, but it keeps the range and the racks of the original.
        if not self._fits(joint, other, -sign) or self._moves_bodies(other):
            raise _Unlike({"why": "range", "name": names(self.of, "joint")[joint]})
        return np.array([[-sign]])

    def _fits(self, joint: int, other: int, sign: float) -> bool:
        """Return whether a joint, with this sign, has the range of its image."""
        if not (self.of.jnt_limited[joint] and self.own.jnt_limited[other]):
            return True
        at, there = (float(m.qpos0[m.jnt_qposadr[each]]) for m, each in ((self.of, joint), (self.own, other)))
        image = np.sort(there + sign * (self.of.jnt_range[joint] - at))
        return bool(np.abs(image - self.own.jnt_range[other]).max() < _NEAR)

    def _moves_bodies(self, joint: int) -> bool:
        data = self.mujoco.MjData(self.own)
        data.qpos[self.own.jnt_qposadr[joint]] += 0.5
        self.mujoco.mj_kinematics(self.own, data)
        return bool(np.abs(data.xpos - self.start[1][0]).max() > _NEAR)

    def key(self, number: int) -> dict[str, list[float]]:
        """Return a key of the image, after MuJoCo has compared the bodies and the forces."""
        of = self.of
        own = self.own
        before, after = self.data
        self.mujoco.mj_resetDataKeyframe(of, before, number)
        self.mujoco.mj_resetData(own, after)
        for joint, other in self.joints.items():
            after.qvel[_at(own, "qvel", other)] = self.turns[joint] @ before.qvel[_at(of, "qvel", joint)]
            self._position(joint, other)
        for actuator, other in self.actuators.items():
            self._control(actuator, other)
        for body, other in self.bodies.items():
            mocap = int(of.body_mocapid[body])
            there = int(own.body_mocapid[other])
            if mocap >= 0 and there >= 0:
                after.mocap_pos[there] = self.flip @ before.mocap_pos[mocap]
                after.mocap_quat[there] = self._turned(before.mocap_quat[mocap], body, other)
        found = {
            "qpos": after.qpos,
            "qvel": after.qvel,
            "act": after.act,
            "ctrl": after.ctrl,
            "mpos": after.mocap_pos,
            "mquat": after.mocap_quat,
        }
        rows = {vector: [round(float(number), 12) + 0.0 for number in row.ravel()] for vector, row in found.items()}
        for model, data in zip((of, own), self.data, strict=True):
            self.mujoco.mj_forward(model, data)
        self._compare_bodies(number)
        if _strain(after) > _strain(before) + _NEAR:
            raise _Unlike({"why": "equality", "key": number})
        for joint, other in self.joints.items():
            ours = before.qfrc_actuator[_at(of, "qvel", joint)]
            theirs = after.qfrc_actuator[_at(own, "qvel", other)]
            if np.abs(self.turns[joint] @ ours - theirs).max() > _NEAR * max(1.0, float(np.abs(ours).max())):
                raise _Unlike({"why": "force", "key": number, "name": names(of, "joint")[joint]})
        return rows

    def _position(self, joint: int, other: int) -> None:
        of = self.of
        own = self.own
        before, after = self.data
        at = _at(of, "qpos", joint)
        there = _at(own, "qpos", other)
        value = before.qpos[at]
        kind = int(of.jnt_type[joint])
        body = int(of.jnt_bodyid[joint])
        image_body = int(own.jnt_bodyid[other])
        if kind == FREE:
            image = np.concatenate([self.flip @ value[:3], self._turned(value[3:], body, image_body)])
        elif kind == BALL:  # as a turn of the body in the world, from the reference on
            starts = [self._quat(start[1][each]) for start, each in zip(self.start, (body, image_body), strict=True)]
            image = self._product(
                _inverse(starts[1]), self._reflected(self._product(starts[0], value, _inverse(starts[0]))), starts[1]
            )
        else:
            image = own.qpos0[there] + self.turns[joint][0] * (value - of.qpos0[at])
        after.qpos[there] = image

    def _control(self, actuator: int, other: int) -> None:
        """Set control and activation of the image of an actuator: positions if it has a stiffness."""
        of = self.of
        own = self.own
        before, after = self.data
        sign = 1.0
        shift = 0.0
        joint = int(of.actuator_trnid[actuator, 0])
        if of.actuator_trntype[actuator] in (0, 1) and of.jnt_type[joint] not in (BALL, FREE):
            gear, image = (
                float(model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=each).start, 0])
                for model, each in ((of, actuator), (own, other))
            )
            sign = float(self.turns[joint][0, 0]) * (np.sign(image) * np.sign(gear) or 1.0)
            if of.actuator_biasprm[actuator, 1]:
                at, there = (int(m.jnt_qposadr[each]) for m, each in ((of, joint), (own, self.joints[joint])))
                shift = image * float(own.qpos0[there]) - sign * gear * float(of.qpos0[at])
        after.ctrl[_at(own, "ctrl", other)] = sign * before.ctrl[_at(of, "ctrl", actuator)] + shift
        after.act[_at(own, "act", other)] = sign * before.act[_at(of, "act", actuator)] + shift

    def _turned(self, quat: Any, body: int, other: int) -> Any:
        """Return the orientation of the image of a body; its frame is turned as at the reference."""
        starts = [self._quat(start[1][each]) for start, each in zip(self.start, (body, other), strict=True)]
        return self._product(self._reflected(quat), _inverse(self._reflected(starts[0])), starts[1])

    def _reflected(self, quat: Any) -> Any:
        return np.concatenate([quat[:1], -np.diag(self.flip) * quat[1:]])

    def _quat(self, matrix: Any) -> Any:
        found = np.zeros(4)
        self.mujoco.mju_mat2Quat(found, matrix.ravel())
        return found

    def _product(self, *quats: Any) -> Any:
        found = quats[0]
        for each in quats[1:]:
            one = found
            found = np.zeros(4)
            self.mujoco.mju_mulQuat(found, one, each)
        return found


def _strain(data: MjData) -> float:
    """Return the largest violation of an equality constraint."""
    return float(np.abs(data.efc_pos[: data.ne]).max(initial=0.0))


def _at(model: MjModel, vector: str, index: int) -> slice:
    found = span(model, vector, index)
    return slice(found.start, found.stop)


def _inverse(quat: Any) -> Any:
    return quat * [1, -1, -1, -1]
