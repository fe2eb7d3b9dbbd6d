"""MuJoCo in other versions, in a Python that the user names or has installed, and the motion of models there."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.limits import in_force
from mjcompose.base.processes import PIPE, Overrun, Process, WorkFolder
from mjcompose.mujoco.arrays import BALL, FREE, SLIDE
from mjcompose.mujoco.programs import ProgramError, python_in, python_of
from mjcompose.tree.history import release

_DUMP = Path(__file__).with_name("dump.py")
_MOST_WORDS = 256 << 20
_LONGEST = 300


class UnknownKeyError(ProgramError):
    """The model has no keyframe with the requested name."""


class RejectedError(ProgramError):
    """A version of MuJoCo rejects the model."""


class CompiledByVersion(Struct):
    """A compiled model: its names and the file with its arrays, or the error of MuJoCo."""

    version: str
    arrays: Path | None = None
    names: Mapping[str, Sequence[str | None]] = field(default_factory=dict)
    words: Mapping[str, Any] = field(default_factory=dict)
    error: str | None = None


class Other(Struct):
    python: Path
    version: str

    def compile(self, model: Path, out: Path) -> CompiledByVersion:
        """Compile a model and write its arrays to a file. Raises ProgramError if MuJoCo does not answer."""
        answer = _run(self.python, [str(model), str(out)], out)
        if answer.get("error") is not None:
            return CompiledByVersion(self.version, error=str(answer["error"]))
        return CompiledByVersion(self.version, out, answer["names"], words=answer["words"])

    def move(self, model: Path, out: Path, asked: Mapping[str, Any]) -> dict[str, Any]:
        """Simulate a model with `dump.py`, which writes its arrays to the file `out`. Raises ProgramError."""
        return _run(self.python, [str(model), str(out), json.dumps(asked)], out)


def this_python() -> Path:
    return Path(sys.executable)


def open_python(python: Path) -> Other:
    """Return the MuJoCo of a Python. Raises ProgramError."""
    if not os.path.exists(python):
        raise ProgramError(f"the Python `{python}` does not exist", "name an interpreter: `VENV/bin/python`")
    if os.path.isdir(python):
        inside = python_of(python)
        if not os.path.exists(inside):
            raise ProgramError(f"`{python}` is a folder without a Python", "name an interpreter or its environment")
        python = inside
    return Other(python.absolute(), str(_run(python.absolute(), [])["version"]))


def kept(version: str, environment: Mapping[str, str]) -> Other:
    """Return an installed version of MuJoCo. Raises MissingError, and ProgramError if it is not trusted."""
    return open_python(python_in(version, environment))


def _run(python: Path, arguments: list[str], out: Path | None = None) -> dict[str, Any]:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    # Pythons before 3.11 know no -P, and -I would hide a MuJoCo in the folder of the user's own packages.
    environment["PYTHONSAFEPATH"] = "1"
    folder = None if out is None else WorkFolder(out.parent, "MuJoCo writes its log beside the arrays")
    seconds = in_force().time
    try:
        command = [str(python), "-B", str(_DUMP), *arguments]
        with Process(command, env=environment, folder=folder, stdout=PIPE, stderr=PIPE) as process:
            answer, said = process.finish(seconds=seconds, most=_MOST_WORDS)
    except OSError as error:
        raise ProgramError(f"`{python}` cannot be run: {(error.strerror or str(error)).lower()}") from None
    except Overrun as overrun:
        if overrun.is_late:
            message = f"the MuJoCo of `{python}` did not answer within {seconds:g} seconds"
            raise ProgramError(message, "give it more with `--timeout`") from None
        raise ProgramError(f"the MuJoCo of `{python}` is not used: {overrun}") from None
    try:
        found = json.loads(answer)
        found["version"] = release(str(found["version"])) or str(found["version"])
    except (ValueError, TypeError, KeyError):
        lines = said.decode("utf-8", "replace").strip().splitlines()
        why = lines[-1][:_LONGEST] if lines else f"it ended with {process.returncode}"
        raise ProgramError(f"the MuJoCo of `{python}` did not answer: {why}", None) from None
    assert isinstance(found, dict)
    return found


TRIALS = ("settle", "hold", "step", "drop")


class Moved(Struct):
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
        apart = f"{self.amount:.3g} {self.unit} apart in `{self.trial}`"
        return f"{self.kind} {self.name}: {apart}, from {self.time:.3g} s on"


class Motion(Struct):
    """The motion of a model in all trials; `answer` comes from `dump.py`."""

    answer: Mapping[str, Any]
    arrays: Path
    seconds: float

    @classmethod
    def of(cls, other: Other, model: Path, out: Path, asked: Mapping[str, Any]) -> Motion:
        """Simulate a model. Raises ProgramError."""
        answer = other.move(model, out, asked)
        if "error" in answer:
            raise RejectedError(f"MuJoCo {other.version} rejects the model: {' '.join(str(answer['error']).split())}")
        if asked["key"] is not None and asked["key"] not in answer["keys"]:
            known = ", ".join(f"`{each}`" for each in answer["keys"])
            help = f"name one of {known}" if known else "name none: the model has no keyframes"
            raise UnknownKeyError(f"the keyframe `{asked['key']}` does not exist", help)
        return cls(answer, out, float(asked["seconds"]))


_ALIKE = 1e-6


def other_inertias(before: Motion, after: Motion) -> list[str]:
    """Return the bodies whose mass, inertia or center of mass the two versions compile differently."""
    import numpy as np

    with np.load(before.arrays, allow_pickle=False) as one, np.load(after.arrays, allow_pickle=False) as other:
        here = dict(zip(before.answer["bodies"], one["inertias"], strict=True))
        there = dict(zip(after.answer["bodies"], other["inertias"], strict=True))
    return [name for name, row in here.items() if not np.allclose(row, there[name], rtol=_ALIKE, atol=_ALIKE * 1e-3)]


def differences(before: Motion, after: Motion, signal: str, tolerance: float) -> list[Moved]:
    """Return the joints (`qpos`) or bodies (`xpos`) that are farther apart than the tolerance, the farthest first.

    Raises ProgramError if the two models differ in joints, bodies or trials, so nothing is left out.
    """
    import numpy as np

    for kind in ("trials", "joints", "bodies"):
        names = [sorted(each[0] if kind == "joints" else each for each in one.answer[kind]) for one in (before, after)]
        if names[0] != names[1]:
            versions = " and ".join(str(each.answer["version"]) for each in (before, after))
            raise ProgramError(f"MuJoCo {versions} have other {kind} of the model, so its motion cannot be compared")
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
