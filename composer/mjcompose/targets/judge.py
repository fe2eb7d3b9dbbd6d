"""Compare a model as a consumer reads it with MuJoCo's model, in MuJoCo's child process.

Both are facts: numbers of bodies, joints and actuators by name, the count of each kind of shape, poses, and the end
of a motion. Reported losses of a target are not compared.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.mujoco.unequal import Bound
from mjcompose.targets.readers.shared import facts as programs
from mjcompose.targets.target import Loss

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

Facts = dict[str, Any]
SECONDS = 0.2
"""The motion from the home key."""
FEATURES = {
    "range": "limits",
    "damping": "damping",
    "friction": "friction",
    "armature": "armature",
    "stiffness": "springs",
    "effort": "effort",
    "force": "effort",
    "joint": "actuators",
    "kp": "gains",
    "kd": "gains",
    "control": "control ranges",
    "com": "inertia",
    "shapes": "shapes",
    "poses": "poses",
    "motion": "motion",
    "forces": "forces",
    "driven": "driven",
}
"""The compared quantity, by its word in the facts."""
_WORDS = {
    "range": "limits",
    "friction": "dry friction",
    "effort": "greatest force",
    "force": "greatest force",
    "kp": "stiffness (`kp`)",
    "kd": "damping (`kv`)",
    "control": "range of the control",
}
_ERASED = {
    "damping": ("dof_damping", "dof_dampingpoly"),
    "polynomials": ("dof_dampingpoly", "jnt_stiffnesspoly"),
    "springs": ("jnt_stiffness", "jnt_stiffnesspoly"),
    "friction": ("dof_frictionloss",),
    "armature": ("dof_armature", "actuator_armature"),
    "gravcomp": ("body_gravcomp",),
    "tendons": (
        "tendon_stiffness",
        "tendon_stiffnesspoly",
        "tendon_damping",
        "tendon_dampingpoly",
        "tendon_frictionloss",
        "tendon_armature",
    ),
    "actuators": ("actuator_armature",),
}
"""Elements that no longer affect the motion after a loss, by feature."""
_MOVED = 0.01
"""How much of the longest way, and of 1, the end of a motion may be off: programs have integrators of their own."""


class ReadDifference(Struct):
    """An element that a consumer has read differently: a feature, the kind and the name of the element, and words."""

    feature: str
    kind: str
    name: str
    message: str


class ReadingQuestion(Struct):
    """The `facts` that a consumer wrote as an answer to the questions `asked`, and the losses of its target.

    `single` allows for a consumer that computes in single precision.
    """

    facts: Facts
    asked: Facts
    single: bool
    losses: Sequence[Loss]

    @classmethod
    def of(cls, data: Facts) -> ReadingQuestion:
        """Return the question that `asdict` turned into data."""
        return cls(**{**data, "losses": [Loss(**loss) for loss in data["losses"]]})


class MotionQuestion(Struct):
    """The questions `asked`, the losses of a target, and the features `without` which a program moves all joints."""

    asked: Facts
    losses: Sequence[Loss]
    without: Sequence[str]

    @classmethod
    def of(cls, data: Facts) -> MotionQuestion:
        """Return the question that `asdict` turned into data."""
        return cls(**{**data, "losses": [Loss(**loss) for loss in data["losses"]]})


def asked_of(mujoco: Any, model: MjModel, count: int) -> Facts:
    """Return the questions for a consumer. It is called by `mjcompose.mujoco.engine.call`."""
    asked = questions(model, count)
    return asked | drives_of(mujoco, model, asked)


def judged(mujoco: Any, model: MjModel, data: Facts) -> list[str]:
    """Answer a `ReadingQuestion`, in words: the differences between the facts and the model without the losses.

    It is called by `mjcompose.mujoco.engine.call`.
    """
    question = ReadingQuestion.of(data)
    read = differences(mujoco, model, question.facts, question.asked, losses=question.losses, single=question.single)
    return [difference.message for difference in read]


def motion_of(mujoco: Any, model: MjModel, data: Facts) -> Facts:
    """Answer a `MotionQuestion`: the end of the motion without the losses; called by `mujoco.engine.call`."""
    question = MotionQuestion.of(data)
    losses = [*question.losses, *_unmoved(model, question.without)]
    motion: Facts = facts_of(mujoco, model, question.asked, losses=losses).get("motion", {})
    return motion


def _unmoved(model: MjModel, without: Iterable[str]) -> list[Loss]:
    """Return the losses of a program that moves all joints without some features."""
    return [Loss(name, "joint", number, tag="joint", name="") for name in without for number in range(model.njnt)]


def questions(model: MjModel, count: int = 50, seed: int = 1) -> Facts:
    """Return the questions for consumers: `count` random `poses`, and the `seconds` of a motion from a pose, `home`.

    A pose has `joints`, a list of numbers (rad, m) by joint name, and `free`, a position (m) and a quaternion
    (w, x, y, z) by body name.
    """
    draw = np.random.default_rng(seed)

    def drawn(number: int, kind: int) -> Any:
        if kind == programs.FREE:
            turned = draw.normal(size=4)
            return [*draw.uniform(-1, 1, 3), *(turned / np.linalg.norm(turned))]
        return draw.uniform(*(model.jnt_range[number] if model.jnt_limited[number] else (-1.0, 1.0)))

    keys = [model.key(number).name for number in range(model.nkey)]
    start = model.key_qpos[keys.index("home") if "home" in keys else 0] if keys else model.qpos0

    def at_home(number: int, kind: int) -> Any:
        at = int(model.jnt_qposadr[number])
        return start[at : at + 7] if kind == programs.FREE else start[at]

    moves = model.nv > 0 and model.nflex == 0
    return {
        "poses": [_pose(model, drawn) for _ in range(count)],
        "home": _pose(model, at_home),
        "seconds": SECONDS if moves else 0,
        "gravity": model.opt.gravity.tolist(),
    }


def _pose(model: MjModel, position: Callable[[int, int], Any]) -> Facts:
    """Return the named joints and free bodies at a position, which is given by number and type of a joint."""
    joints: dict[str, list[float]] = {}
    free: dict[str, list[float]] = {}
    for number in range(model.njnt):
        kind = int(model.jnt_type[number])
        name = model.joint(number).name
        body = model.body(int(model.jnt_bodyid[number])).name
        if kind in (programs.SLIDE, programs.HINGE) and name:
            joints[name] = [float(position(number, kind))]
        elif kind == programs.FREE and body:
            free[body] = [float(coordinate) for coordinate in position(number, kind)]
    return {"joints": joints, "free": free}


_SHARES = (1.0, 0.25, 0.05, 0.01)
_SMOOTH = 0.002
"""Relative to the longest way: with half the step, a motion that is compared ends at most this far away."""
_NONE = 0
_AFFINE = 1  # mjBIAS_NONE, mjBIAS_AFFINE, and also mjGAIN_FIXED, mjDYN_NONE, mjTRN_JOINT


def drives_of(mujoco: Any, model: MjModel, asked: Facts) -> Facts:
    """Return the `drives`, motors and servos of joints by name, with their full and their eased controls.

    Full control is the upper end of its range. A motion under full control may be so violent that each integrator makes
    another one of it; the eased controls are the largest share that MuJoCo follows with half the step, too. `eases`
    says whether there is one.
    """
    drives: Facts = {}
    for number in range(model.nu):
        name = model.actuator(number).name
        drive = _drive(model, number)
        if name and drive is not None:
            drives[name] = drive
    found: Facts = {"drives": drives, "eases": False}
    if asked["seconds"]:
        for share in _SHARES:
            for name, drive in drives.items():
                drive["eased"] = _controls(model, model.actuator(name).id, drive["input"], asked["home"], share=share)
            _, once = _driven(mujoco, model, asked | found)
            _, twice = _driven(mujoco, model, asked | found, halved=True)
            way = max([abs(end - asked["home"]["joints"][name][0]) for name, end in twice.items()], default=0.0)
            if max([abs(once[name] - end) for name, end in twice.items()], default=0.0) <= _SMOOTH * max(way, 0.01):
                found["eases"] = True
                break
    for name, drive in drives.items():
        drive["full"] = _controls(model, model.actuator(name).id, drive["input"], asked["home"])
    return found


def _drive(model: MjModel, number: int) -> Facts | None:
    """Return the joint and the input of a motor or a servo of a hinge or a slide, or None for other actuators."""
    joint = int(model.actuator_trnid[number][0])
    words = ("trntype", "dyntype", "gaintype")
    is_simple = not any(int(getattr(model, f"actuator_{word}")[number]) for word in words)
    delays = getattr(model, "actuator_delay", None)
    if not is_simple or not model.actuator_gear[number][0] or (delays is not None and delays[number]):
        return None
    kind = int(model.jnt_type[joint])
    name = model.joint(joint).name
    if kind not in (programs.SLIDE, programs.HINGE) or not name or model.jnt_actgravcomp[joint]:
        return None
    gain = float(model.actuator_gainprm[number][0])
    bias = model.actuator_biasprm[number][:3].tolist()
    if int(model.actuator_biastype[number]) == _NONE:
        return {"joint": name, "input": "force"} if gain else None
    if int(model.actuator_biastype[number]) != _AFFINE or bias[0]:
        return None
    if gain and bias[1] == -gain:
        return {"joint": name, "input": "position"}
    return {"joint": name, "input": "velocity"} if gain and bias == [0, 0, -gain] else None


def _controls(model: MjModel, number: int, word: str, home: Facts, share: float = 1.0) -> Facts:
    """Return a share of the full control from the pose `home` on, and the same at the joint."""
    gear = float(model.actuator_gear[number][0])
    gain = float(model.actuator_gainprm[number][0])
    at_joint = gain * gear if word == "force" else 1 / gear
    full = float(model.actuator_ctrlrange[number][1]) if model.actuator_ctrllimited[number] else 0.5 / abs(at_joint)
    start = 0.0
    if word == "position":
        start = home["joints"][model.joint(int(model.actuator_trnid[number][0])).name][0] / at_joint
    control = start + share * (full - start)
    if model.actuator_ctrllimited[number]:
        control = float(np.clip(control, *model.actuator_ctrlrange[number]))
    return {"control": control, "at_joint": control * at_joint}


def _driven(
    mujoco: Any, model: MjModel, asked: Facts, *, halved: bool = False
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the forces of the joints at home under full controls, and where they end under eased ones."""
    only = programs.with_drives(model, asked["drives"])
    only.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    only.opt.timestep = programs.STEP / (2 if halved else 1)
    data = mujoco.MjData(only)
    data.qpos = programs.qpos(model, asked["home"])
    for name, drive in asked["drives"].items():
        data.ctrl[model.actuator(name).id] = drive.get("full", drive["eased"])["control"]
    mujoco.mj_forward(only, data)
    dofs = {name: int(model.joint(name).dofadr[0]) for name in asked["home"]["joints"]}
    forces = {name: float(data.qfrc_actuator[dof]) for name, dof in dofs.items()}
    for name, drive in asked["drives"].items():
        data.ctrl[model.actuator(name).id] = drive["eased"]["control"]
    for _ in range(round(asked["seconds"] / only.opt.timestep)):
        mujoco.mj_step(only, data)
    return forces, {name: float(data.qpos[int(model.joint(name).qposadr[0])]) for name in asked["home"]["joints"]}


def without_lost(asked: Facts, losses: Iterable[Loss]) -> Facts:
    """Return the questions without the drives that a target does not have, or not with all of their force."""
    lost = {(loss.feature, loss.name) for loss in losses if not loss.otherwise}
    drives = {
        name: drive
        for name, drive in asked.get("drives", {}).items()
        if not {("actuators", name), ("gears", name), ("effort", name), ("effort", drive["joint"])} & lost
    }
    return {**asked, "drives": drives}


def facts_of(mujoco: Any, model: MjModel, asked: Facts, losses: Sequence[Loss] = ()) -> Facts:
    """Return the facts of a compiled model, as consumers write them, with the end of the motion after the losses."""

    def placed(rows: Any) -> Any:
        data = mujoco.MjData(model)
        found = []
        for row in rows:
            data.qpos = row
            mujoco.mj_kinematics(model, data)
            found.append((data.xpos.copy(), data.xmat.copy()))
        return zip(*found, strict=True)

    def moved(start: Any, steps: int) -> Any:
        free = programs.without_forces(mujoco, _erased(model, losses))
        free.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        data = mujoco.MjData(free)
        data.qpos = start
        for _ in range(steps):
            mujoco.mj_step(free, data)
        return data.qpos

    read = programs.of_mujoco(None, model, lambda name: getattr(model, name), placed=placed, moved=moved)
    found: Facts = programs.answered(asked, *read)
    if asked.get("drives"):
        found["forces"], ends = _driven(mujoco, _erased(model, losses), asked)
        found |= {"driven": ends} if asked["eases"] else {}
    return found


def _erased(model: MjModel, losses: Sequence[Loss]) -> Any:
    """Return a copy of the model in which lost elements do nothing."""
    model = copy.copy(model)
    for loss in losses:
        if loss.feature == "computing":
            model.opt.density = 0
            model.opt.viscosity = 0
        if loss.feature == "gains" and loss.kind == "actuator":
            model.actuator_biasprm[loss.number][2] = 0
        for array in _ERASED.get(loss.feature, ()):
            values = getattr(model, array, None)
            if values is None or loss.kind != _KIND_OF.get(array.partition("_")[0]):
                continue
            rows = model.dof_jntid == loss.number if array.startswith("dof_") else loss.number
            values[rows] = 0
    return model


_KIND_OF = {"dof": "joint", "jnt": "joint", "body": "body", "tendon": "tendon", "actuator": "actuator"}


def differences(
    mujoco: Any, model: MjModel, facts: Facts, asked: Facts, losses: Sequence[Loss] = (), *, single: bool
) -> Iterator[ReadDifference]:
    """Yield the differences between a consumer's reading and the model. Losses do not count.

    `single` allows for a consumer that computes in single precision.
    """
    truth = facts_of(mujoco, model, asked, losses=[*losses, *_unmoved(model, facts.get("without", ()))])
    lost = {(loss.feature, loss.name) for loss in losses if not loss.otherwise}
    facts = by_actuator(truth, facts)
    composite = bool(facts.get("composite"))
    yield from _masses(mujoco, model, facts, tolerance=2e-6 if single else 1e-9)
    for kind in ("joint", "actuator"):
        yield from _elements(kind, truth, facts, lost, tolerance=1e-5 if single else 1e-9)
    if "shapes" in facts:
        yield from _shapes(model, truth["shapes"], facts["shapes"], losses=losses)
    yield from _poses(truth["poses"], facts["poses"], composite, tolerance=1e-4 if single else 1e-9)
    if "motion" in facts and "motion" in truth:
        yield from _motions(truth["motion"], facts["motion"], asked["home"]["joints"], "motion")
    if "forces" in facts and "forces" in truth:
        yield from _forces(truth["forces"], facts["forces"], tolerance=1e-5 if single else 1e-9)
    if "driven" in facts and "driven" in truth:
        yield from _motions(truth["driven"], facts["driven"], asked["home"]["joints"], "driven")


def _elements(
    kind: str, truth: Facts, facts: Facts, lost: set[tuple[str, str]], tolerance: float
) -> Iterator[ReadDifference]:
    """Yield the joints or actuators that are missing, and the differences of those that are not.

    A consumer that reads no actuators at all misses none.
    """
    reads_actuators = bool(facts["actuators"] or "commands" in facts)
    for name, mine in truth[f"{kind}s"].items():
        read = facts[f"{kind}s"].get(name)
        if read is not None:
            yield from _attributes(kind, name, mine, read=read, lost=lost, tolerance=tolerance)
        elif kind == "joint" or (reads_actuators and ("actuators", name) not in lost):
            yield ReadDifference(f"{kind}s", kind, name, message=f"the {kind} `{name}` is missing")


def by_actuator(truth: Facts, facts: Facts) -> Facts:
    """Return the facts with the commands of joints, which a URDF has, under the names of their actuators."""
    commands = {
        joint: {word: value for word, value in command.items() if word != "input"}
        for joint, command in facts.get("commands", {}).items()
    }
    by_name = {
        name: {"joint": mine["joint"], **commands[mine["joint"]]}
        for name, mine in truth["actuators"].items()
        if mine["joint"] in commands
    }
    return {**facts, "actuators": {**facts["actuators"], **by_name}}


def _forces(mine: dict[str, float], read: dict[str, float], tolerance: float) -> Iterator[ReadDifference]:
    for name, force in mine.items():
        if name in read and not Bound(tolerance).allows(force, read[name]):
            message = f"under full control the force of the joint `{name}` is {_shown(read[name])}, not {_shown(force)}"
            yield ReadDifference("forces", "joint", name, message=message)


def _attributes(
    kind: str, name: str, mine: Facts, read: Facts, lost: set[tuple[str, str]], tolerance: float
) -> Iterator[ReadDifference]:
    for attribute, value in read.items():
        feature = FEATURES[attribute]
        if attribute not in mine or (feature, name) in lost or (feature == "gains" and ("gears", name) in lost):
            continue
        if not _is_close(value, mine[attribute], Bound(tolerance)):
            words = _WORDS.get(attribute, attribute)
            message = f"the {words} of the {kind} `{name}` is {_shown(value)}, not {_shown(mine[attribute])}"
            yield ReadDifference(feature, kind, name, message=message)


def _is_close(read: Any, mine: Any, bound: Bound) -> bool:
    if isinstance(read, list) and isinstance(mine, list):
        return len(read) == len(mine) and all(map(_is_close, read, mine, [bound] * len(mine)))
    if isinstance(read, float | int) and isinstance(mine, float | int):
        return bound.allows(mine, read)
    if isinstance(read, list) or isinstance(mine, list):  # no limit is the same as none on both sides
        return not any(each is not None for each in [*(read or ()), *(mine or ())])
    return bool(read == mine)


def _shapes(
    model: MjModel, mine: dict[str, int], read: dict[str, int], losses: Iterable[Loss]
) -> Iterator[ReadDifference]:
    left = dict(mine)
    for loss in losses:
        if loss.feature == "shapes" and loss.kind == "geom":
            left[programs.SHAPES[int(model.geom_type[loss.number])]] -= 1
    if "all" in read:
        left = {"all": sum(left.values())}
    for kind in sorted({*left, *read}):
        if left.get(kind, 0) != read.get(kind, 0):
            of = "" if kind == "all" else f" of the type `{kind}`"
            message = f"there are {read.get(kind, 0)} geoms{of}, not {left.get(kind, 0)}"
            yield ReadDifference("shapes", "geom", kind, message=message)


def _masses(mujoco: Any, model: MjModel, facts: Facts, tolerance: float) -> Iterator[ReadDifference]:
    composite = bool(facts.get("composite"))
    for body in range(1, model.nbody):
        name = model.body(body).name
        message = None
        # Each program gives nameless bodies a name of its own; in a composite, a fixed body is part of its holder.
        if not name or (composite and model.body_weldid[body] != body):
            continue
        parts = [each for each in range(model.nbody) if model.body_weldid[each] == body] if composite else [body]
        mass, com, inertia = _composite(mujoco, model, body, parts=parts)
        read = facts["bodies"].get(name)
        if read is None:
            message = f"the body `{name}` is missing"
        elif abs(read["mass"] - mass) > tolerance * max(1.0, mass):
            message = f"the mass of `{name}` is {read['mass']:.9g}, not {mass:.9g}"
        elif mass > 0 and np.abs(np.array(read["com"]) - com).max() > max(tolerance, 1e-7):
            message = f"the center of mass of `{name}` is at {_shown(read['com'])}, not {_shown(com)}"
        elif mass > 0 and np.abs(np.array(read["inertia"]) - inertia).max() > tolerance * np.abs(inertia).max() + 1e-12:
            message = f"the inertia of `{name}` is {_shown(read['inertia'])}, not {_shown(inertia)}"
        if message is not None:
            yield ReadDifference("inertia", "body", name, message=message)


def _composite(mujoco: Any, model: MjModel, body: int, parts: list[int]) -> tuple[float, Any, Any]:
    """Return mass (kg), center (m), shape (3,), and inertia about it (kg·m²), shape (3, 3), of a body and its parts.

    Center and inertia are in the frame of the body.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    frame = data.xmat[body].reshape(3, 3)
    origin = data.xpos[body]
    masses = model.body_mass[parts]
    mass = float(masses.sum())
    if mass == 0:
        return 0.0, np.zeros(3), np.zeros((3, 3))
    center = (masses[:, None] * data.xipos[parts]).sum(axis=0) / mass
    inertia = np.zeros((3, 3))
    for part in parts:
        axes = data.ximat[part].reshape(3, 3)
        off = data.xipos[part] - center
        inertia += axes @ np.diag(model.body_inertia[part]) @ axes.T
        inertia += model.body_mass[part] * (off @ off * np.eye(3) - np.outer(off, off))
    return mass, frame.T @ (center - origin), frame.T @ inertia @ frame


def _poses(mine: Sequence[Facts], read: Sequence[Facts], composite: bool, tolerance: float) -> Iterator[ReadDifference]:
    worst = 0.0
    where = ""
    for true, each in zip(mine, read, strict=True):
        for name, pose in true.items():
            if name in each:
                off = max(float(np.abs(np.subtract(*pair)).max()) for pair in zip(each[name], pose, strict=True))
                if off > worst:
                    worst = off
                    where = name
            elif not composite:
                yield ReadDifference("poses", "body", name, message=f"the body `{name}` has no pose")
                return
    if worst > tolerance:
        yield ReadDifference("poses", "body", where, message=f"the pose of `{where}` is up to {worst:.3g} off")


def _motions(mine: dict[str, float], read: dict[str, float], start: Facts, feature: str) -> Iterator[ReadDifference]:
    way = max([abs(end - start[name][0]) for name, end in mine.items() if name in start], default=0.0)
    off = {name: abs(read[name] - end) for name, end in mine.items() if name in read}
    name = max(off, key=lambda each: off[each] if np.isfinite(off[each]) else np.inf, default="")
    if off and not off[name] <= _MOVED * max(way, 0.01):
        ends = f"{_shown(read[name])}, not at {_shown(mine[name])}"
        how = "motion" if feature == "motion" else "motion under control"
        message = f"after {SECONDS:g} s of {how} the joint `{name}` is at {ends}"
        yield ReadDifference(feature, "joint", name, message=message)


def _shown(value: Any) -> str:
    if value is None:
        return "without limit"
    return " ".join(
        each if isinstance(each, str) else "none" if each is None else f"{each:.6g}"
        for each in np.ravel(np.array(value, dtype=object))
    )
