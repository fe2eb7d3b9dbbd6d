"""Comparison of the motion of one model in two versions of MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.mujoco.arrays import BALL, FREE, SLIDE
from mjcompose.mujoco.environments import Other, OtherError


class UnknownKeyError(OtherError):
    """The model has no keyframe of the name that a request says."""


class RejectedError(OtherError):
    """A version of MuJoCo rejects the model."""


TRIALS = ("settle", "hold", "step", "drop")


@dataclass(frozen=True, slots=True)
class Moved:
    """A joint or body that moves differently: the greatest `amount` in its `unit`, in a `trial`, first after `time`."""

    kind: str
    name: str
    amount: float
    unit: str
    trial: str
    time: float

    @property
    def words(self) -> str:
        """The line that commands print."""
        return (
            f"{self.kind} {self.name}: {self.amount:.3g} {self.unit} apart in `{self.trial}`, from {self.time:.3g} s on"
        )


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion of a model in all trials; `answer` is the answer of `motion.py`."""

    answer: Mapping[str, Any]
    arrays: Path
    seconds: float

    @classmethod
    def of(cls, other: Other, model: Path, out: Path, asked: Mapping[str, Any]) -> Motion:
        """Simulate a model. Raises OtherError."""
        answer = other.move(model, out, asked)
        if "error" in answer:
            raise RejectedError(f"MuJoCo {other.version} rejects the model: {' '.join(str(answer['error']).split())}")
        if asked["key"] is not None and asked["key"] not in answer["keys"]:
            known = ", ".join(f"`{each}`" for each in answer["keys"])
            help = f"name one of {known}" if known else "name none: the model has no keyframes"
            raise UnknownKeyError(f"the keyframe `{asked['key']}` does not exist", help)
        return cls(answer, out, float(asked["seconds"]))


def differences(before: Motion, after: Motion, signal: str, tolerance: float) -> list[Moved]:
    """Return the joints (`qpos`) or bodies (`xpos`) that are farther apart than the tolerance, the farthest first.

    Raises OtherError if the two have other joints, bodies or trials, so nothing is left out.
    """
    import numpy as np

    for kind in ("trials", "joints", "bodies"):
        names = [sorted(each[0] if kind == "joints" else each for each in one.answer[kind]) for one in (before, after)]
        if names[0] != names[1]:
            versions = " and ".join(str(each.answer["version"]) for each in (before, after))
            raise OtherError(f"MuJoCo {versions} have other {kind} of the model, so its motion cannot be compared")
    found: dict[tuple[str, str], Moved] = {}
    with np.load(before.arrays, allow_pickle=False) as one, np.load(after.arrays, allow_pickle=False) as other:
        for number, trial in enumerate(before.answer["trials"]):
            rows = one[f"{signal}-{number}"], other[f"{signal}-{after.answer['trials'].index(trial)}"]
            apart = _of_joints(before, after, rows) if signal == "qpos" else _of_bodies(before, after, rows)
            for kind, name, unit, distances in apart:
                distances = np.where(np.isfinite(distances), distances, np.inf)
                first = int((distances > tolerance).argmax())
                if distances[first] > tolerance:
                    at = before.seconds * (first + 1) / len(distances)
                    moved = Moved(kind, name, float(distances.max()), unit=unit, trial=trial, time=at)
                    known = found.get((name, unit))
                    found[name, unit] = moved if known is None or moved.amount > known.amount else known
    return sorted(found.values(), key=lambda each: -each.amount)


def _of_joints(before: Motion, after: Motion, rows: Sequence[Any]) -> Iterator[tuple[str, str, str, Any]]:
    """Yield for each joint its kind, name and unit, and the distances at all times."""
    import numpy as np

    there = {name: at for name, _, at in after.answer["joints"]}
    for name, kind, at in before.answer["joints"]:
        one, other = (row[:, first : first + 7] for row, first in zip(rows, (at, there[name]), strict=True))
        if kind == FREE:
            yield "joint", name, "m", np.linalg.norm(one[:, :3] - other[:, :3], axis=1)
        if kind in (FREE, BALL):
            turned = [row[:, 3:7] if kind == FREE else row[:, :4] for row in (one, other)]
            chords = [np.linalg.norm(turned[0] - sign * turned[1], axis=1) for sign in (1, -1)]
            yield "joint", name, "rad", 4 * np.arcsin(np.minimum(np.minimum(*chords) / 2, 1.0))
        else:
            yield "joint", name, "m" if kind == SLIDE else "rad", np.abs(one[:, 0] - other[:, 0])


def _of_bodies(before: Motion, after: Motion, rows: Sequence[Any]) -> Iterator[tuple[str, str, str, Any]]:
    import numpy as np

    there = {name: index for index, name in enumerate(after.answer["bodies"])}
    for index, name in enumerate(before.answer["bodies"]):
        yield "body", name, "m", np.linalg.norm(rows[0][:, index] - rows[1][:, there[name]], axis=1)
