"""The check `settles`: a simulation from a keyframe comes to rest."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.build.checks.check import SOLVED, Scope, beside, failed
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, Name, Number
from mjcompose.language.form import Schema, kind_of
from mjcompose.mujoco.arrays import JOINT_TYPES

SECONDS, MAX_SPEED = 1.0, 0.05


@dataclass(frozen=True, slots=True)
class Settles:
    """After `seconds` from `key`, no speed is above `max_speed` (m/s, rad/s).

    Without a key, the model starts from the reference configuration. With `within`, every joint must then be that
    close (m, rad) to its position in the key `near`, or in `key` itself.
    """

    word: ClassVar[str] = "settles"
    name: str
    key: str | None
    seconds: float
    max_speed: float
    at: Path
    near: str | None = None
    within: float | None = None


class Near:
    """Form of the keyframe to which the model stays near, and how near."""

    form = Keyed(
        "",
        Key("key", Name("the name of a keyframe"), "a keyframe; without it, the one where it starts"),
        Key(
            "within",
            Number(above=0),
            "how far a joint may be from where it is there, in m or rad",
            needed="0.05",
        ),
    )

    def read(self, keys: Keys, value: Any, *at: str | int) -> Mapping[str, Any]:
        if not isinstance(value, dict):
            key = f"key: {value}, " if isinstance(value, str) else ""
            message = f"`{at[-1]}` of {keys.owner} is a mapping, got {kind_of(value)}"
            keys.add("wrong-type", message, *at, help=f"write for instance `{at[-1]}: {{{key}within: 0.05}}`")
            return {}
        inner = Keys(keys.name, str(at[-1]), value, faults=[])
        found = self.form.read(inner)
        for fault in inner.faults:
            keys.faults.append(replace(fault, at=(keys.name, keys.word, *fault.at[1:])))
        return found

    def schema(self) -> Schema:
        return self.form.schema()


FORM = Keyed(
    "The model comes to rest: simulated from a keyframe, it does not diverge and stands still at the end.",
    Key("key", Name("the name of a keyframe"), "where it starts; without it, the reference configuration"),
    Key("seconds", Number(above=0), "how long it is simulated", default=SECONDS),
    Key(
        "max_speed",
        Number(above=0),
        "the greatest speed of a joint in the last tenth of that time, in m/s or rad/s",
        default=MAX_SPEED,
    ),
    Key("near", Near(), "that all joints are still near to where they are in a keyframe", default={}),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Settles:
    near = found["near"]
    return Settles(
        keys.name,
        found["key"],
        found["seconds"],
        max_speed=found["max_speed"],
        at=at,
        near=near.get("key"),
        within=near.get("within"),
    )


KIND = Kind("settles", FORM, make, example="{key: home}")

_AT_THE_END = 0.1
"""The final share of the simulated time in which speeds are checked."""


def check(scope: Scope, asked: dict[str, Any]) -> list[Fault]:
    """Report a simulation that diverges or does not come to rest."""
    import numpy as np

    from mjcompose.mujoco.controls import Divergence, steps_in

    mujoco, model = scope.mujoco, scope.model
    data = scope.at_key(asked["key"])
    if isinstance(data, Fault):
        return [data]
    diverged = Divergence(mujoco, model, data)
    limit, seconds = asked["max_speed"], asked["seconds"]
    if not model.opt.timestep > 0:
        return [failed("no time passes: the timestep of the model is 0", "a timestep above 0", "0")]
    steps = steps_in(model, seconds)
    dofs = np.flatnonzero([int(joint) in scope.joints for joint in model.dof_jntid])
    fastest, at, dof = 0.0, 0.0, -1
    first = steps - max(1, round(_AT_THE_END * steps))
    for step in range(steps):
        mujoco.mj_step(model, data)
        if diverged:  # MuJoCo resets it, so it is at rest
            message = f"the simulation diverges after {(step + 1) * model.opt.timestep:.4g} s"
            return [
                failed(
                    message, f"at rest after {seconds:g} s", "not finite, or beyond all measure", "seconds"
                )
            ]
        if step >= first and len(dofs):
            speeds = np.abs(data.qvel[dofs])
            worst = int(speeds.argmax())
            if speeds[worst] > fastest:
                fastest, at, dof = float(speeds[worst]), float(data.time), int(dofs[worst])
    scope.found("speed", fastest, SOLVED)
    if fastest <= limit:
        return [] if asked["within"] is None else _near(scope, data, asked)
    joint = int(model.dof_jntid[dof])
    unit = _unit(model, dof, joint)
    speed = beside(fastest, limit)
    message = f"{scope.called('joint', joint)} still moves at {speed} {unit} after {at:.4g} s"
    return [failed(message, f"at most {limit:g} {unit}", f"{speed} {unit}", "max_speed")]


def _near(scope: Scope, data: Any, asked: dict[str, Any]) -> list[Fault]:
    """Report joints that end far from their position in a keyframe."""
    import numpy as np

    named = asked["near"] is not None
    there = scope.at_key(asked["near"] if named else asked["key"])
    if isinstance(there, Fault):
        return [replace(there, at=("near", "key"))]
    mujoco, model = scope.mujoco, scope.model
    apart = np.zeros(model.nv)
    mujoco.mj_differentiatePos(model, apart, 1.0, there.qpos, data.qpos)
    own = [dof for dof in range(model.nv) if int(model.dof_jntid[dof]) in scope.joints]
    if not own:
        return []
    dof = max(own, key=lambda each: abs(apart[each]))
    farthest = float(abs(apart[dof]))
    scope.found("distance", farthest, SOLVED)
    if farthest <= asked["within"]:
        return []
    joint = int(model.dof_jntid[dof])
    unit = _unit(model, dof, joint).removesuffix("/s")
    where = (
        f"`{asked['near'] or asked['key']}`"
        if asked["near"] or asked["key"]
        else "the reference configuration"
    )
    off = beside(farthest, asked["within"])
    message = f"{scope.called('joint', joint)} is {off} {unit} from where it is in {where}"
    wanted = f"at most {asked['within']:g} {unit}"
    return [failed(message, wanted, f"{off} {unit}", "near", "within")]


def _unit(model: Any, dof: int, joint: int) -> str:
    """Return the unit of the velocity of a degree of freedom."""
    from mjcompose.mujoco.addresses import span

    units = JOINT_TYPES[int(model.jnt_type[joint])].velocity_units
    return units[dof - span(model, "qvel", joint).start]
