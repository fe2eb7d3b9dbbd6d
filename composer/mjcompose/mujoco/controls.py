"""Controls of a compiled model: their units and gains, and the controls that hold a pose. Imports no MuJoCo.

MuJoCo computes force = gainprm[0] * input + biasprm[0] + biasprm[1] * length + biasprm[2] * velocity if the gain is
fixed and the bias affine. The tags `motor`, `position` and `velocity` are special cases of this formula. The controls
of servos that hold a pose produce no force there; controls that balance gravity and contacts come from `mj_inverse`.

As in MuJoCo, angles are in radians and lengths in meters. The unit of a quaternion is the word itself, and `1` is a
plain number. None means that the unit depends on the model's author.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.addresses import RUNS, rows_of, span
from mjcompose.mujoco.arrays import ANGLE, JOINT_TYPES, LENGTH
from mjcompose.mujoco.attributes import names
from mjcompose.mujoco.references import ON_JOINTS, ON_TENDON

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjData, MjModel

FIXED = 0
"""A value of `actuator_gaintype`: the gain is constant."""
NO_BIAS = 0
"""A value of `actuator_biastype`: the force has no bias."""
AFFINE = 1
"""A value of `actuator_biastype`: the bias depends on length and velocity."""

GAINS: Mapping[tuple[str, str], tuple[tuple[str, int, int], ...]] = {
    ("position", "kp"): (("actuator_gainprm", 0, 1), ("actuator_biasprm", 1, -1)),
    ("position", "kv"): (("actuator_biasprm", 2, -1),),
    ("velocity", "kv"): (("actuator_gainprm", 0, 1), ("actuator_biasprm", 2, -1)),
}
"""By tag and attribute: the arrays that store it, with column and sign."""


def is_by_plugin(model: MjModel, actuator: int) -> bool:
    """Return whether a plugin computes the force. MuJoCo 4.0 then stores the gain 1 and no bias."""
    return len(model.actuator_plugin) > 0 and int(model.actuator_plugin[actuator]) >= 0


def servo(model: MjModel, actuator: int) -> dict[str, float] | None:
    """Return the gains by name: `gain` of a motor, `kp` and `kv` of a position servo, `kv` of a velocity servo.

    Return None for any other actuator. `kp` is in N/m or N·m/rad, `kv` in N·s/m or N·m·s/rad if the gear is 1.
    """
    if is_by_plugin(model, actuator):
        return None
    gain = float(model.actuator_gainprm[actuator, 0])
    bias = model.actuator_biasprm[actuator, :3].tolist()
    kinds = int(model.actuator_gaintype[actuator]), int(model.actuator_biastype[actuator])
    if kinds == (FIXED, NO_BIAS):
        return {"gain": gain}
    if kinds != (FIXED, AFFINE) or bias[0]:
        return None
    if bias[1] == -gain and gain:
        return {"kp": gain, "kv": -bias[2]}
    return {"kv": gain} if bias[1] == 0 and bias[2] == -gain else None


FORCES = {ANGLE: "N m", LENGTH: "N"}
"""The unit of the force along a coordinate with that unit."""

_SENSORS = {
    "touch": "N",
    "accelerometer": "m/s^2",
    "velocimeter": "m/s",
    "gyro": "rad/s",
    "force": "N",
    "torque": "N m",
    "camprojection": "px",
    "tendonpos": "m",
    "tendonvel": "m/s",
    "tendonactuatorfrc": "N",
    "ballquat": "quaternion",
    "ballangvel": "rad/s",
    "tendonlimitpos": "m",
    "tendonlimitvel": "m/s",
    "tendonlimitfrc": "N",
    "framepos": "m",
    "framequat": "quaternion",
    "framexaxis": "1",
    "frameyaxis": "1",
    "framezaxis": "1",
    "framelinvel": "m/s",
    "frameangvel": "rad/s",
    "framelinacc": "m/s^2",
    "frameangacc": "rad/s^2",
    "subtreecom": "m",
    "subtreelinvel": "m/s",
    "subtreeangmom": "kg m^2/s",
    "insidesite": "1",
    "distance": "m",
    "normal": "1",
    "fromto": "m",
    "e_potential": "J",
    "e_kinetic": "J",
    "clock": "s",
}
_OF_JOINTS = {"pos": "{}", "vel": "{}/s", "frc": None}
"""The quantities that sensors of joints and actuators measure, by the suffix of their tag."""


def of_sensor(tag: str, dimension: int, about: str | None) -> str | None:
    """Return the unit of a sensor; `about` is the unit of the coordinate of its joint or actuator."""
    if tag == "rangefinder":
        return LENGTH if dimension == 1 else None  # with more fields it is more than a distance
    if not tag.startswith(("joint", "actuator")):
        return _SENSORS.get(tag)
    if about is None:
        return None
    form = _OF_JOINTS[tag[-3:]]
    return FORCES[about] if form is None else form.format(about)


def of_transmission(model: MjModel, row: int) -> str | None:
    """Return the unit of an actuator's length: its coordinate's, unless a gear scales it."""
    kind = int(model.actuator_trntype[row])
    target = int(model.actuator_trnid[row, 0])
    scale, *others = model.actuator_gear[rows_of(model, "actuator", "actuator_gear", index=row).start]
    if abs(scale) != 1 or any(others):
        return None
    if kind in ON_JOINTS:
        return JOINT_TYPES[int(model.jnt_type[target])].coordinate
    return LENGTH if kind == ON_TENDON else None


def of_control(model: MjModel, mujoco: Any, row: int) -> str | None:
    """Return the unit of an actuator's only control: a position or velocity of a servo, a force, an activation."""
    dynamics = int(model.actuator_dyntype[row])
    if dynamics == int(mujoco.mjtDyn.mjDYN_MUSCLE):
        return "1"
    about = of_transmission(model, row)
    gains = servo(model, row)
    if about is None or gains is None or dynamics >= int(mujoco.mjtDyn.mjDYN_USER):
        return None
    rate = "/s" if dynamics == int(mujoco.mjtDyn.mjDYN_INTEGRATOR) else ""
    if gains.get("kp", 0) > 0:
        return about + rate
    if gains.get("kv", 0) > 0 and not rate:
        return f"{about}/s"
    return FORCES[about] if gains.get("gain") == 1 and not rate else None


_MOST = 10**9
_WARNINGS = (("QPOS", "qpos", "position"), ("QVEL", "qvel", "velocity"), ("QACC", "qvel", "acceleration"))


def steps_in(model: MjModel, seconds: float) -> int:
    """Return the number of steps for a time: at least one, and at most `_MOST`."""
    timestep = float(model.opt.timestep)
    return max(1, round(seconds / timestep)) if timestep * _MOST > seconds else _MOST


class Divergence:
    """Reads the warnings that MuJoCo has counted since the simulation began."""

    def __init__(self, mujoco: Any, model: MjModel, data: MjData) -> None:
        self.model = model
        kinds = mujoco.mjtWarning
        self._warnings = {row: data.warning[int(getattr(kinds, f"mjWARN_BAD{row[0]}"))] for row in _WARNINGS}

    def __bool__(self) -> bool:
        return any(each.number for each in self._warnings.values())

    def __str__(self) -> str:
        """Say which number became NaN, infinite, or larger than MuJoCo accepts."""
        (_, vector, word), number = next((row, each.lastinfo) for row, each in self._warnings.items() if each.number)
        where = f"number {number} of {vector}"
        for joint, name in enumerate(names(self.model, "joint")):
            if number in span(self.model, vector, joint):
                where = f"joint `{name}`" if name else f"joint {joint}, which has no name"
        return f"NaN or a huge {word} in {where}"


def advance(
    mujoco: Any, model: MjModel, data: MjData, end: float, begun: float = 0.0, most: float = math.inf
) -> str | None:
    """Step until `end` s after `begun`, for at most `most` s of real time. Return the reason if it stops early."""
    if not model.opt.timestep > 0:
        return "the timestep of the model is 0, so no time passes"
    divergence = Divergence(mujoco, model, data)
    latest = time.monotonic() + most
    for _ in range(steps_in(model, end - (data.time - begun)) + 1):
        if data.time - begun >= end or time.monotonic() > latest:
            break
        now = data.time - begun
        mujoco.mj_step(model, data)
        if divergence:
            return f"unstable: {divergence} after {now + model.opt.timestep:.4g} s"
    return None


_CLOSE = 1e-6
_NOISE = 1e-9
_DIGITS = 12
_POSITION = 1  # the first bit of `actuator_ctrlspec`
_INPUT = 8  # where `actuator_gainprm` has the `input` of a `dcmotor`, up to MuJoCo 3.11
_SETPOINTS = 7  # its bits of position, velocity and force; a higher bit is a voltage, or a form of rotation


def hold(mujoco: Any, model: MjModel, question: dict[str, Any]) -> dict[str, Any]:
    """Return controls and activations that hold the pose of the key `key`; runs under `mjcompose.mujoco.engine.call`.

    `forces` are the addresses of the controls that balance the forces on the model there, next to the forces of all
    other actuators, and `positions` of those that give no force there. The answer has `ctrl` and `act`, each None if
    nothing holds. `unlike` has the kind of the actuators without such a control, by the address of their control.
    `unknown` has the controls of actuators whose law only a plugin or a program knows, and `left` has the force or
    torque in N or N m that they cannot balance.
    """
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, question["key"])
    data.qvel[:] = data.qacc[:] = 0
    mujoco.mj_fwdPosition(model, data)
    laws = [_Law(mujoco, model, data, index=index) for index in range(len(model.actuator_gaintype))]
    forces = np.zeros(len(laws))
    left = 0.0
    balancing = [law for law in laws if law.gain and law.control in question["forces"]]
    if balancing:
        _rest(model, data, [law for law in laws if law.control in question["positions"]])
        forces, left = _balance(mujoco, model, data, balancing=balancing, count=len(laws))
    ctrl: list[float | None] = [None] * model.nu
    act: list[float | None] = [None] * model.na
    for law, force in zip(laws, forces, strict=True):
        law.write(float(force), ctrl, act)
    unlike = {str(law.control): law.kind for law in laws if law.kind and law not in balancing}
    unknown = [law.control for law in laws if law.is_unknown and law.controls]
    return {"ctrl": ctrl, "act": act, "unlike": unlike, "unknown": unknown, "left": left}


def _setpoints(mujoco: Any, model: MjModel, index: int, gain: int) -> int:
    """Return which setpoints the controls of a `pid` or `dcmotor` are, in the bits of `_SETPOINTS`; 0 for others."""
    gains = mujoco.mjtGain
    if not hasattr(gains, "mjGAIN_PID"):
        # MuJoCo 3.11 has no `pid`, and a `dcmotor` has one control: a voltage (0), a position (1) or a velocity (2).
        return int(model.actuator_gainprm[index, _INPUT]) if gain == int(gains.mjGAIN_DCMOTOR) else 0
    if gain in (int(gains.mjGAIN_PID), int(gains.mjGAIN_DCMOTOR)):
        return int(model.actuator_ctrlspec[index]) & _SETPOINTS
    return 0


class _Law:
    """One actuator at the pose: `kind` names its type if no control holds the pose, and is empty otherwise."""

    def __init__(self, mujoco: Any, model: MjModel, data: MjData, index: int) -> None:
        gains = mujoco.mjtGain
        biases = mujoco.mjtBias
        dynamics = mujoco.mjtDyn
        self.index = index
        self.controls = span(model, "ctrl", index)
        self.states = span(model, "act", index)
        self.control = self.controls.start if self.controls else -1
        self.length = float(data.actuator_length[RUNS["actuator"]["nout"].rows(model, index).start])
        gain, bias, dynamic = (int(getattr(model, f"actuator_{name}type")[index]) for name in ("gain", "bias", "dyn"))
        by_plugin = is_by_plugin(model, index)
        self.spec = _setpoints(mujoco, model, index, gain)
        self.integrates = dynamic == int(dynamics.mjDYN_INTEGRATOR)
        self.filters = dynamic in (int(dynamics.mjDYN_FILTER), int(dynamics.mjDYN_FILTEREXACT))
        is_direct = dynamic == int(dynamics.mjDYN_NONE) or self.integrates or self.filters
        self.gain = 0.0
        self.bias = 0.0
        if is_direct and not by_plugin:
            self.gain, self.bias = self._line(mujoco, model, gain, bias)
        user = (int(gains.mjGAIN_USER), int(biases.mjBIAS_USER), int(dynamics.mjDYN_USER))
        self.is_unknown = by_plugin or any(map(int.__eq__, (gain, bias, dynamic), user))
        self.kind = ""
        if self.is_unknown:
            self.kind = "a plugin" if by_plugin else "an actuator of a user's own type"
        elif not self.spec:
            self.kind = self._kind_without_spring(model.actuator_biasprm[index], bias == int(biases.mjBIAS_AFFINE))

    def _kind_without_spring(self, biasprm: np.ndarray, is_affine: bool) -> str:
        """Return the kind of an actuator that pulls to no position; empty if it does."""
        if self.gain and is_affine and biasprm[1] != 0:
            return ""
        return "a motor" if self.gain and not np.any(biasprm[:3]) else "no servo for positions"

    def _line(self, mujoco: Any, model: MjModel, gain_type: int, bias_type: int) -> tuple[float, float]:
        """Return the force per control and the force without one, at this length; zeros if the law is another one."""
        gains = mujoco.mjtGain
        biases = mujoco.mjtBias
        if gain_type not in (int(gains.mjGAIN_FIXED), int(gains.mjGAIN_AFFINE)):
            return 0.0, 0.0
        if bias_type not in (int(biases.mjBIAS_NONE), int(biases.mjBIAS_AFFINE)):
            return 0.0, 0.0
        gainprm = model.actuator_gainprm[self.index]
        biasprm = model.actuator_biasprm[self.index]
        gain = float(gainprm[0])
        bias = 0.0
        if gain_type == int(gains.mjGAIN_AFFINE):
            gain += float(gainprm[1]) * self.length
        if bias_type == int(biases.mjBIAS_AFFINE):
            bias = float(biasprm[0] + biasprm[1] * self.length)
        return gain, bias

    def write(self, force: float, ctrl: list[float | None], act: list[float | None]) -> None:
        if self.spec:
            for at, bit in enumerate((each for each in range(3) if self.spec >> each & 1), self.control):
                ctrl[at] = self.length if 1 << bit == _POSITION else 0.0
            return
        value = (force - self.bias) / self.gain if self.gain else 0.0
        if force:
            value = float(f"{value:.{_DIGITS}g}")
        for at in self.controls:
            ctrl[at] = 0.0 if self.integrates else value
        if self.gain and self.states and (self.integrates or self.filters):
            act[self.states[-1]] = value


def _rest(model: MjModel, data: MjData, laws: list[_Law]) -> None:
    """Write the controls and activations into `data` at which the actuators give no force."""
    ctrl: list[float | None] = [None] * model.nu
    act: list[float | None] = [None] * model.na
    for law in laws:
        law.write(0.0, ctrl, act)
    for now, values in ((data.ctrl, ctrl), (data.act, act)):
        for at, value in enumerate(values):
            if value is not None:
                now[at] = value


def moment_arms(mujoco: Any, model: MjModel, data: MjData) -> np.ndarray:
    """Return the moment arms of the first output of each actuator (m, or 1), shape (actuators, nv)."""
    found = _moments(mujoco, model, data)
    first = getattr(model, "actuator_outadr", None)
    return found if first is None else found[first]


def sparse_arms(model: MjModel, data: MjData) -> list[dict[int, float]]:
    """Return the moment arms of the first output of each actuator (m, or 1) by dof, without zeros."""
    outputs = getattr(model, "actuator_outadr", None)
    rows = range(len(data.moment_rownnz)) if outputs is None else outputs.tolist()
    columns = data.moment_colind.ravel().tolist()
    values = data.actuator_moment.ravel().tolist()
    starts = data.moment_rowadr.tolist()
    counts = data.moment_rownnz.tolist()
    places = (range(starts[row], starts[row] + counts[row]) for row in rows)
    return [{columns[at]: values[at] for at in inside if values[at]} for inside in places]


def _moments(mujoco: Any, model: MjModel, data: MjData) -> np.ndarray:
    """Return the moment arms of all outputs, shape (outputs, nv)."""
    found = np.zeros((len(data.moment_rownnz), model.nv))
    moments = data.actuator_moment.ravel()
    columns = data.moment_colind.ravel()
    mujoco.mju_sparse2dense(found, moments, data.moment_rownnz, data.moment_rowadr, columns)
    return found


def _forces_of_others(mujoco: Any, model: MjModel, data: MjData, balancing: list[_Law]) -> np.ndarray:
    """Return the forces on all dofs of the actuators that do not balance, at the controls of `data`."""
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(model, data)
    forces = np.array(data.actuator_force)
    for law in balancing:
        rows = RUNS["actuator"]["nout"].rows(model, law.index)
        forces[rows.start : rows.stop] = 0
    return np.asarray(_moments(mujoco, model, data).T @ forces)


def _balance(mujoco: Any, model: MjModel, data: MjData, balancing: list[_Law], count: int) -> tuple[np.ndarray, float]:
    """Return the actuator forces that balance the dofs that they move, and the remaining force."""
    others = _forces_of_others(mujoco, model, data, balancing)
    mujoco.mj_inverse(model, data)
    rows = moment_arms(mujoco, model, data)[[law.index for law in balancing]]
    moved = np.flatnonzero(np.abs(rows).max(axis=0, initial=0) > 0)
    found = np.zeros(count)
    if not len(moved):
        return found, 0.0
    wanted = (data.qfrc_inverse - others)[moved]
    solved = np.linalg.lstsq(rows[:, moved].T, wanted, rcond=None)[0]
    for law, force in zip(balancing, solved, strict=True):
        # Solved values differ in their last digits between machines, and models must not.
        found[law.index] = 0.0 if abs(force) < _NOISE else float(f"{force:.{_DIGITS}g}")
    rest = float(np.abs(rows[:, moved].T @ solved - wanted).max(initial=0))
    return found, rest if rest > _CLOSE * max(1.0, float(np.abs(wanted).max(initial=0))) else 0.0
