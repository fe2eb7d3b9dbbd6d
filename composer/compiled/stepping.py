"""Simulate for a while, whatever the model does.

MuJoCo sets a simulation that diverges back to its beginning, with the time 0, and only counts a warning. So a loop that
waits for a time may never end; this one counts its steps, and says which joint diverged.
"""

from __future__ import annotations

import math
import time
from typing import Any

from composer.compiled.addresses import span
from composer.compiled.kinds import Model, names

_MOST = 10**9
_WARNINGS = (
    ("mjWARN_BADQPOS", "qpos", "position"),
    ("mjWARN_BADQVEL", "qvel", "velocity"),
    ("mjWARN_BADQACC", "qvel", "acceleration"),
)


def steps_in(model: Model, seconds: float) -> int:
    """Return how many steps a time takes: at least one, and a limited number however short they are."""
    timestep = float(model.opt.timestep)
    return max(1, round(seconds / timestep)) if timestep * _MOST > seconds else _MOST


class Divergence:
    """Looks at the warnings of a simulation, which MuJoCo counts from its beginning."""

    def __init__(self, mujoco: Any, model: Model, data: Any) -> None:
        self.model = model
        self._warnings = [data.warning[int(getattr(mujoco.mjtWarning, name))] for name, _, _ in _WARNINGS]

    def __bool__(self) -> bool:
        return any(each.number for each in self._warnings)

    def __str__(self) -> str:
        """Say which number became NaN, infinite, or larger than MuJoCo accepts."""
        number, (_, vector, word) = next(
            (each.lastinfo, row) for each, row in zip(self._warnings, _WARNINGS, strict=True) if each.number
        )
        where = f"number {number} of {vector}"
        for joint, name in enumerate(names(self.model, "joint")):
            if number in span(self.model, vector, joint):
                where = f"joint `{name}`" if name else f"joint {joint}, which has no name"
        return f"NaN or a huge {word} in {where}"


def advance(
    mujoco: Any, model: Model, data: Any, end: float, begun: float = 0.0, most: float = math.inf
) -> str | None:
    """Step until `end` seconds after the time `begun`, or for `most` seconds of this machine's time.

    Return why the simulation cannot go on, or None.
    """
    if not model.opt.timestep > 0:
        return "the timestep of the model is 0, so no time passes"
    divergence, latest = Divergence(mujoco, model, data), time.monotonic() + most
    for _ in range(steps_in(model, end - (data.time - begun)) + 1):
        if data.time - begun >= end or time.monotonic() > latest:
            break
        now = data.time - begun
        mujoco.mj_step(model, data)
        if divergence:
            return f"unstable: {divergence} after {now + model.opt.timestep:.4g} s"
    return None
