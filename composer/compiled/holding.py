"""The controls that hold a pose, computed in MuJoCo's child process.

The force of an actuator is `gain · control + bias`, where the bias of a servo is a spring to a position. The
controls of servos that hold a pose produce no force there; those that balance gravity and contacts come from
`mj_inverse`.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from composer.compiled.servos import is_by_plugin

_CLOSE, _NOISE, _DIGITS = 1e-6, 1e-9, 12
_POSITION = 1  # the first bit of `actuator_ctrlspec`
_SETPOINTS = 7  # its bits of position, velocity and force; a higher bit is a voltage, or a form of rotation


def hold(mujoco: Any, model: Any, question: dict[str, Any]) -> dict[str, Any]:
    """Return the controls and activations that hold the pose of the key `key`; runs under `composer.engine.call`.

    With `forces`, the actuators balance the forces on the model there. The answer has `ctrl` and `act`, each None
    where nothing holds; `unlike`, the kind of the actuators without such a control, by the address of their
    control; `unknown`, the controls of actuators whose law only a plugin or a program knows; and `left`, the force or
    torque in N or N m that they cannot balance.
    """
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, question["key"])
    data.qvel[:] = 0
    data.qacc[:] = 0
    mujoco.mj_fwdPosition(model, data)
    laws = [_Law(mujoco, model, data, index=index) for index in range(_count(model))]
    forces, left = np.zeros(len(laws)), 0.0
    if question["forces"]:
        mujoco.mj_inverse(model, data)
        forces, left = _balance(mujoco, model, data, laws=[law for law in laws if law.gain], count=len(laws))
    ctrl: list[float | None] = [None] * model.nu
    act: list[float | None] = [None] * model.na
    for law, force in zip(laws, forces, strict=True):
        law.write(float(force), ctrl, act)
    unlike = {
        str(law.control): law.kind for law in laws if law.kind and not (question["forces"] and law.gain)
    }
    unknown = [law.control for law in laws if law.is_unknown and law.count]
    return {"ctrl": ctrl, "act": act, "unlike": unlike, "unknown": unknown, "left": left}


def _count(model: Any) -> int:
    return len(model.actuator_gaintype)


class _Law:
    """One actuator at the pose: `kind` names its type if no control holds the pose, and is empty otherwise."""

    def __init__(self, mujoco: Any, model: Any, data: Any, index: int) -> None:
        gains, biases, dynamics = mujoco.mjtGain, mujoco.mjtBias, mujoco.mjtDyn
        self.index = index
        self.control = int(model.actuator_ctrladr[index]) if hasattr(model, "actuator_ctrladr") else index
        self.count = int(model.actuator_ctrlnum[index]) if hasattr(model, "actuator_ctrlnum") else 1
        self.state, self.states = int(model.actuator_actadr[index]), int(model.actuator_actnum[index])
        output = int(model.actuator_outadr[index]) if hasattr(model, "actuator_outadr") else index
        self.length = float(data.actuator_length[output])
        self.output = output
        gain, bias, dynamic = (
            int(getattr(model, f"actuator_{name}type")[index]) for name in ("gain", "bias", "dyn")
        )
        gainprm, biasprm = model.actuator_gainprm[index], model.actuator_biasprm[index]
        by_plugin = is_by_plugin(model, index)
        self.spec = 0
        if hasattr(model, "actuator_ctrlspec") and gain in (int(gains.mjGAIN_PID), int(gains.mjGAIN_DCMOTOR)):
            self.spec = int(model.actuator_ctrlspec[index]) & _SETPOINTS
        self.integrates = dynamic == int(dynamics.mjDYN_INTEGRATOR)
        self.filters = dynamic in (int(dynamics.mjDYN_FILTER), int(dynamics.mjDYN_FILTEREXACT))
        is_affine = not by_plugin and gain in (int(gains.mjGAIN_FIXED), int(gains.mjGAIN_AFFINE)) and bias in (
            int(biases.mjBIAS_NONE), int(biases.mjBIAS_AFFINE),
        )  # fmt: skip
        plain = dynamic == int(dynamics.mjDYN_NONE) or self.integrates or self.filters
        self.gain = self.bias = 0.0
        if is_affine and plain:
            self.gain = float(gainprm[0])
            if gain == int(gains.mjGAIN_AFFINE):
                self.gain += float(gainprm[1]) * self.length
            if bias == int(biases.mjBIAS_AFFINE):
                self.bias = float(biasprm[0] + biasprm[1] * self.length)
        spring = bias == int(biases.mjBIAS_AFFINE) and biasprm[1] != 0
        self.kind = ""
        if not self.spec and not (self.gain and spring):
            self.kind = "a motor" if self.gain and not np.any(biasprm[:3]) else "no servo for positions"
        user = (int(gains.mjGAIN_USER), int(biases.mjBIAS_USER), int(dynamics.mjDYN_USER))
        self.is_unknown = by_plugin or any(map(int.__eq__, (gain, bias, dynamic), user))
        if self.is_unknown:
            self.kind = "a plugin" if by_plugin else "an actuator of a user's own type"

    def write(self, force: float, ctrl: list[float | None], act: list[float | None]) -> None:
        if self.spec:
            at = self.control
            for bit in range(3):
                if self.spec >> bit & 1:
                    ctrl[at] = self.length if 1 << bit == _POSITION else 0.0
                    at += 1
            return
        value = (force - self.bias) / self.gain if self.gain else 0.0
        if force:
            value = float(f"{value:.{_DIGITS}g}")
        for at in range(self.control, self.control + self.count):
            ctrl[at] = 0.0 if self.integrates else value
        if self.gain and self.states and (self.integrates or self.filters):
            act[self.state + self.states - 1] = value


def _balance(mujoco: Any, model: Any, data: Any, laws: list[_Law], count: int) -> tuple[np.ndarray, float]:
    """Return the actuator forces that balance `qfrc_inverse` on the dofs that they move, and the remaining force."""
    moments = np.zeros((len(data.moment_rownnz), model.nv))
    mujoco.mju_sparse2dense(
        moments, data.actuator_moment, data.moment_rownnz, data.moment_rowadr, data.moment_colind
    )
    rows = moments[[law.output for law in laws]]
    moved = np.flatnonzero(np.abs(rows).max(axis=0, initial=0) > 0)
    found = np.zeros(count)
    if not len(moved):
        return found, 0.0
    wanted = data.qfrc_inverse[moved]
    solved = np.linalg.lstsq(rows[:, moved].T, wanted, rcond=None)[0]
    for law, force in zip(laws, solved, strict=True):
        # Solved values differ in their last digits between machines, and models must not.
        found[law.index] = 0.0 if abs(force) < _NOISE else float(f"{force:.{_DIGITS}g}")
    rest = float(np.abs(rows[:, moved].T @ solved - wanted).max(initial=0))
    return found, rest if rest > _CLOSE * max(1.0, float(np.abs(wanted).max(initial=0))) else 0.0
