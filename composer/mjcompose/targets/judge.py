"""Compare a model as a consumer reads it with MuJoCo's model, in MuJoCo's child process.

Both are facts: numbers of bodies, joints and actuators by name, the count of each kind of shape, poses, and the end
of a motion. Reported losses of a target are not compared.
"""

from __future__ import annotations

import copy
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np

from mjcompose.base.dataclass import Struct
from mjcompose.targets.readers.shared import facts as programs
from mjcompose.targets.target import Loss

Facts = dict[str, Any]
SECONDS = 0.2
"""The motion from the home key."""
FEATURES = {
    "range": "limits", "damping": "damping", "friction": "friction", "armature": "armature", "stiffness": "springs",
    "effort": "effort", "force": "effort", "joint": "actuators", "kp": "gains", "kd": "gains", "com": "inertia",
    "shapes": "shapes", "poses": "poses", "motion": "motion",
}  # fmt: skip
"""The compared quantity, by its word in the facts."""
_WORDS = {
    "range": "limits", "friction": "dry friction", "effort": "greatest force", "force": "greatest force",
    "kp": "stiffness (`kp`)", "kd": "damping (`kv`)",
}  # fmt: skip
_ERASED = {
    "damping": ("dof_damping", "dof_dampingpoly"),
    "polynomials": ("dof_dampingpoly", "jnt_stiffnesspoly"),
    "springs": ("jnt_stiffness", "jnt_stiffnesspoly"),
    "friction": ("dof_frictionloss",),
    "armature": ("dof_armature", "actuator_armature"),
    "gravcomp": ("body_gravcomp",),
    "tendons": ("tendon_stiffness", "tendon_stiffnesspoly", "tendon_damping", "tendon_dampingpoly",
                "tendon_frictionloss", "tendon_armature"),
    "actuators": ("actuator_armature",),
}  # fmt: skip
"""Elements that no longer affect the motion after a loss, by feature."""
_MOVED = 0.01
"""How much of the longest way, and of 1, the end of a motion may be off: programs have integrators of their own."""


class Difference(Struct):
    """An element that a consumer has read differently: a feature, the kind and the name of the element, and words."""

    feature: str
    kind: str
    name: str
    message: str


def asked_of(_mujoco: object, model: Any, count: int) -> Facts:
    """Return the questions for a consumer. It is called by `mjcompose.mujoco.engine.call`."""
    return questions(model, count)


def judged(mujoco: Any, model: Any, question: Facts) -> list[str]:
    """Return the differences between the `facts` and the model without the `losses`, in words.

    It is called by `mjcompose.mujoco.engine.call`.
    """
    question = {**question, "losses": [Loss(**each) for each in question["losses"]]}
    return [each.message for each in differences(mujoco, model, **question)]


def motion_of(mujoco: Any, model: Any, question: Facts) -> Facts:
    """Return the end of the motion, without the losses of a target; called by `mjcompose.mujoco.engine.call`."""
    losses = [Loss(**each) for each in question["losses"]] + _unmoved(model, question["without"])
    found: Facts = facts_of(mujoco, model, question["asked"], losses=losses).get("motion", {})
    return found


def _unmoved(model: Any, without: Iterable[str]) -> list[Loss]:
    """Return the losses of a program that moves all joints without some features."""
    return [Loss(name, "joint", number, tag="joint", name="") for name in without for number in range(model.njnt)]


def questions(model: Any, count: int = 50, seed: int = 1) -> Facts:
    """Return the questions for consumers: `count` random `poses`, and the `seconds` of a motion from a pose, `home`.

    A pose has `joints`, a list of numbers (rad, m) by joint name, and `free`, a position (m) and a quaternion
    (w, x, y, z) by body name.
    """
    draw = np.random.default_rng(seed)

    def pose(position: Any) -> Facts:
        joints: dict[str, list[float]] = {}
        free: dict[str, list[float]] = {}
        for number in range(model.njnt):
            kind, name = int(model.jnt_type[number]), model.joint(number).name
            body = model.body(int(model.jnt_bodyid[number])).name
            if kind in (programs.SLIDE, programs.HINGE) and name:
                joints[name] = [float(position(number, kind))]
            elif kind == programs.FREE and body:
                free[body] = [float(each) for each in position(number, kind)]
        return {"joints": joints, "free": free}

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
        "poses": [pose(drawn) for _ in range(count)], "home": pose(at_home), "seconds": SECONDS if moves else 0,
        "gravity": model.opt.gravity.tolist(),
    }  # fmt: skip


def facts_of(mujoco: Any, model: Any, asked: Facts, losses: Sequence[Loss] = ()) -> Facts:
    """Return the facts of a compiled model, as consumers write them, with the end of the motion after the losses."""

    def placed(rows: Any) -> Any:
        data, found = mujoco.MjData(model), []
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
    return found


def _erased(model: Any, losses: Sequence[Loss]) -> Any:
    """Return a copy of the model in which lost elements do nothing."""
    model = copy.copy(model)
    for loss in losses:
        if loss.feature == "computing":
            model.opt.density, model.opt.viscosity = 0, 0
        for array in _ERASED.get(loss.feature, ()):
            values = getattr(model, array, None)
            if values is None or loss.kind != _KIND_OF.get(array.partition("_")[0]):
                continue
            rows = model.dof_jntid == loss.number if array.startswith("dof_") else loss.number
            values[rows] = 0
    return model


_KIND_OF = {"dof": "joint", "jnt": "joint", "body": "body", "tendon": "tendon", "actuator": "actuator"}


def differences(
    mujoco: Any, model: Any, facts: Facts, asked: Facts, losses: Sequence[Loss] = (), *, single: bool
) -> Iterator[Difference]:
    """Yield the differences between a consumer's reading and the model. Losses do not count.

    `single` allows for a consumer that computes in single precision.
    """
    truth = facts_of(mujoco, model, asked, losses=[*losses, *_unmoved(model, facts.get("without", ()))])
    lost = {(loss.feature, loss.name) for loss in losses}
    composite = bool(facts.get("composite"))
    yield from _masses(mujoco, model, facts, tolerance=2e-6 if single else 1e-9)
    for kind in ("joint", "actuator"):
        for name, mine in truth[f"{kind}s"].items():
            read = facts[f"{kind}s"].get(name)
            if read is None and (kind == "joint" or (facts["actuators"] and ("actuators", name) not in lost)):
                yield Difference(f"{kind}s", kind, name, message=f"the {kind} `{name}` is missing")
            if read is not None:
                yield from _attributes(kind, name, mine, read=read, lost=lost, tolerance=1e-5 if single else 1e-9)
    if "shapes" in facts:
        yield from _shapes(model, truth["shapes"], facts["shapes"], losses=losses)
    yield from _poses(truth["poses"], facts["poses"], composite, tolerance=1e-4 if single else 1e-9)
    if "motion" in facts and "motion" in truth:
        yield from _motions(truth["motion"], facts["motion"], asked["home"]["joints"])


def _attributes(
    kind: str, name: str, mine: Facts, read: Facts, lost: set[tuple[str, str]], tolerance: float
) -> Iterator[Difference]:
    for attribute, value in read.items():
        feature = FEATURES[attribute]
        if attribute not in mine or (feature, name) in lost or (feature == "gains" and ("gears", name) in lost):
            continue
        if not _close(value, mine[attribute], tolerance):
            words = _WORDS.get(attribute, attribute)
            message = f"the {words} of the {kind} `{name}` is {_shown(value)}, not {_shown(mine[attribute])}"
            yield Difference(feature, kind, name, message=message)


def _close(read: Any, mine: Any, tolerance: float) -> bool:
    if isinstance(read, list) and isinstance(mine, list):
        return len(read) == len(mine) and all(map(_close, read, mine, [tolerance] * len(mine)))
    if isinstance(read, float | int) and isinstance(mine, float | int):
        return abs(read - mine) <= tolerance * max(1.0, abs(mine))
    if isinstance(read, list) or isinstance(mine, list):  # no limit is the same as none on both sides
        return not any(each is not None for each in [*(read or ()), *(mine or ())])
    return bool(read == mine)


def _shapes(model: Any, mine: dict[str, int], read: dict[str, int], losses: Iterable[Loss]) -> Iterator[Difference]:
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
            yield Difference("shapes", "geom", kind, message=message)


def _masses(mujoco: Any, model: Any, facts: Facts, tolerance: float) -> Iterator[Difference]:
    composite = bool(facts.get("composite"))
    for body in range(1, model.nbody):
        name, message = model.body(body).name, None
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
            yield Difference("inertia", "body", name, message=message)


def _composite(mujoco: Any, model: Any, body: int, parts: list[int]) -> tuple[float, Any, Any]:
    """Return mass (kg), center (m), shape (3,), and inertia about it (kg·m²), shape (3, 3), of a body and its parts.

    Center and inertia are in the frame of the body.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    frame, origin = data.xmat[body].reshape(3, 3), data.xpos[body]
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


def _poses(mine: Sequence[Facts], read: Sequence[Facts], composite: bool, tolerance: float) -> Iterator[Difference]:
    worst, where = 0.0, ""
    for true, each in zip(mine, read, strict=True):
        for name, pose in true.items():
            if name in each:
                off = max(float(np.abs(np.subtract(*pair)).max()) for pair in zip(each[name], pose, strict=True))
                if off > worst:
                    worst, where = off, name
            elif not composite:
                yield Difference("poses", "body", name, message=f"the body `{name}` has no pose")
                return
    if worst > tolerance:
        yield Difference("poses", "body", where, message=f"the pose of `{where}` is up to {worst:.3g} off")


def _motions(mine: dict[str, float], read: dict[str, float], start: Facts) -> Iterator[Difference]:
    way = max([abs(end - start[name][0]) for name, end in mine.items() if name in start], default=0.0)
    off = {name: abs(read[name] - end) for name, end in mine.items() if name in read}
    name = max(off, key=lambda each: off[each] if np.isfinite(off[each]) else np.inf, default="")
    if off and not off[name] <= _MOVED * max(way, 0.01):
        ends = f"{_shown(read[name])}, not at {_shown(mine[name])}"
        message = f"after {SECONDS:g} s of motion the joint `{name}` is at {ends}"
        yield Difference("motion", "joint", name, message=message)


def _shown(value: Any) -> str:
    if value is None:
        return "without limit"
    return " ".join(each if isinstance(each, str) else "none" if each is None else f"{each:.6g}"
                    for each in np.ravel(np.array(value, dtype=object)))  # fmt: skip
