"""The work of `mjcompose identify` in MuJoCo's process: read recordings, check them, fit, and answer with data."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from mjcompose.mujoco.fingerprint import fingerprints
from mjcompose.tools.identify.curves import curves_of
from mjcompose.tools.identify.fit import choose_window, fit_starts, with_window
from mjcompose.tools.identify.intervals import LITTLE, Verdict, fit_and_know, verdicts
from mjcompose.tools.identify.problem import FitSettings, Problem
from mjcompose.tools.identify.recording import Recording, Signal, read_recording
from mjcompose.tools.identify.tables import RecordingFault, Series, SizeLimits
from mjcompose.tools.identify.unknowns import UnknownNumber, unknowns_of

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel


def fit_recordings(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    """Return the fitted numbers with all that is known of them, or a `fault`; runs under `engine.call`."""
    begin = time.perf_counter()
    try:
        problem, held_out = _opened(mujoco, model, asked)
        of_recipe = _errors_of_recipe(problem)
        problem, solution, knowledge = fit_and_know(problem)
    except RecordingFault as fault:
        return {"fault": _fault_data(fault)}
    errors = {"recipe": of_recipe, "fitted": problem.errors(solution.values, solution.starts)}
    recipe = problem.root_mean_squares(of_recipe)
    fitted = problem.root_mean_squares(errors["fitted"])
    curves = [{**curve, "used": "fit"} for curve in curves_of(problem, errors)] if asked["curves"] else []
    held: dict[str, dict[Signal, float]] = {}
    if held_out:
        other = Problem(mujoco, model, problem.unknowns, held_out, problem.settings)
        errors = {"recipe": _followed(other, other.nominal), "fitted": _followed(other, solution.values)}
        held = {word: other.root_mean_squares(each) for word, each in errors.items()}
        if asked["curves"]:
            curves += [{**curve, "used": "held out"} for curve in curves_of(other, errors)]
    std = knowledge.std
    return {
        "numbers": [
            {**_number_data(unknown), "value": float(value), "std": float(deviation), **_verdict_data(verdict)}
            for unknown, value, deviation, verdict in zip(
                problem.unknowns, solution.values, std, verdicts(problem, solution, knowledge), strict=True
            )
        ],
        "correlation": (knowledge.covariance / np.outer(std, std)).tolist(),
        "errors": [
            {
                "signal": signal.word,
                "recipe": recipe[signal],
                "fitted": fitted[signal],
                "correlated": knowledge.times[signal],
                "held_out": {word: errors[signal] for word, errors in held.items() if signal in errors},
            }
            for signal in recipe
        ],
        "recordings": [_recording_data(each) for each in problem.recordings],
        "held_out": [_recording_data(each) for each in held_out],
        "topics": fingerprints(mujoco, model, {"prefix": "", "numbers": _measured(problem.unknowns)})["topics"],
        "window": problem.settings.window,
        "steps": solution.steps,
        "simulated_steps": problem.simulator.steps,
        "seconds": time.perf_counter() - begin,
        "curves": curves,
    }


def plan_recordings(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    """Return the information of the recordings about each number, from one Jacobian, or a `fault`."""
    try:
        problem, _ = _opened(mujoco, model, asked)
    except RecordingFault as fault:
        return {"fault": _fault_data(fault)}
    low = problem.low + 0.02 * (problem.high - problem.low)
    values = np.clip(problem.nominal, low, problem.high)
    starts = fit_starts(problem, values, 1)
    jacobian = problem.jacobian(np.concatenate((values, starts)))
    covariance = np.linalg.pinv(jacobian.T @ jacobian, hermitian=True)
    std = np.sqrt(np.diag(covariance))[: problem.count]
    numbers = []
    for unknown, deviation, prior in zip(problem.unknowns, std, problem.prior, strict=True):
        little = bool(1 - (deviation / prior) ** 2 < LITTLE)
        numbers.append({**_number_data(unknown), "prior": float(prior), "std": float(deviation), "little": little})
    return {"numbers": numbers}


def follow_recording(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> dict[str, Any]:
    """Return the error of each signal of a recording, with the starts that fit best, or a `fault`."""
    try:
        problem, _ = _opened(mujoco, model, asked)
    except RecordingFault as fault:
        return {"fault": _fault_data(fault)}
    errors = problem.root_mean_squares(_followed(problem, problem.nominal))
    return {"errors": {signal.word: error for signal, error in errors.items()}}


def _opened(mujoco: Any, model: MjModel, asked: dict[str, Any]) -> tuple[Problem, list[Recording]]:
    """Return the problem and the held-out recordings. Raises RecordingFault."""
    unknowns = unknowns_of(mujoco, model, asked["fields"])
    limits = SizeLimits(asked["limits"]["size"], asked["limits"]["numbers"])

    keys = {**asked["keys"], "prefix": asked.get("prefix", "")}

    def read(recordings: Sequence[Mapping[str, str]]) -> list[Recording]:
        return [read_recording(mujoco, model, Path(each["path"]), each["file"], keys, limits) for each in recordings]

    recordings = read(asked["recordings"])
    held_out = read(asked["held_out"])
    if not held_out and len(recordings) == 1 and asked["splits"]:
        recordings, held_out = _split(recordings[0])
    path = Path(asked["progress"])
    settings = FitSettings(asked["start"], asked["window"], lambda text: _note(path, text))
    problem = Problem(mujoco, model, unknowns, recordings, settings)
    return with_window(problem, choose_window(problem)), held_out


def _note(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")


def _split(recording: Recording) -> tuple[list[Recording], list[Recording]]:
    """Return the first four fifths of a recording, and the held-out rest."""
    cut = int(0.8 * len(recording.times))
    if recording.seconds < 1.0:
        return [recording], []
    first = replace(
        recording,
        times=recording.times[:cut],
        signals={signal: values[:cut] for signal, values in recording.signals.items()},
    )
    begin = float(recording.times[cut])
    rest = replace(
        recording,
        times=recording.times[cut:] - begin,
        signals={signal: values[cut:] for signal, values in recording.signals.items()},
        commands={name: command._replace(times=command.times - begin) for name, command in recording.commands.items()},
    )
    return [first], [rest]


def _errors_of_recipe(problem: Problem) -> list[Series]:
    problem.settings.progress("how the recipe follows the recordings")
    return _followed(problem, problem.nominal)


def _followed(problem: Problem, values: Series) -> list[Series]:
    """Return the errors of each piece with the best starts."""
    return problem.errors(values, fit_starts(problem, values))


def _fault_data(fault: RecordingFault) -> dict[str, Any]:
    return {
        "code": fault.code,
        "message": fault.message,
        "help": fault.help,
        "line": fault.line,
        "field": fault.field,
        "file": fault.file,
        "at": fault.at,
    }


def _number_data(unknown: UnknownNumber) -> dict[str, Any]:
    return {
        "kind": unknown.kind,
        "names": list(unknown.names),
        "attribute": unknown.attribute,
        "recipe": unknown.nominal,
        "range": [unknown.low, unknown.high],
    }


def _verdict_data(verdict: Verdict) -> dict[str, Any]:
    return {"verdict": verdict.word, "reason": verdict.reason}


def _measured(unknowns: Sequence[UnknownNumber]) -> list[dict[str, Any]]:
    return [
        {"kind": unknown.kind, "names": list(unknown.names), "attribute": unknown.attribute} for unknown in unknowns
    ]


def _recording_data(recording: Recording) -> dict[str, Any]:
    return {
        "file": recording.file,
        "sha256": recording.sha256,
        "seconds": recording.seconds,
        "samples": len(recording.times),
    }
