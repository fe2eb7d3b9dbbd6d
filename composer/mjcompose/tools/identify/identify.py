"""Fit the numbers of a recipe to recordings of a robot."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.limits import in_force
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.language.identify import Identify
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.messages import CRASH_HELP, CRASHES
from mjcompose.plan.read import Given
from mjcompose.sources.context import Context
from mjcompose.text.node import locate
from mjcompose.tools.identify.file import text_of
from mjcompose.tools.identify.judgment import findings_of
from mjcompose.tools.identify.model import FitModel, open_model, span_of_field
from mjcompose.tools.identify.work import fit_recordings, plan_recordings
from mjcompose.verify.compile import WHOLE

_PATIENCE = 0.3
_CRASHED = {
    "mujoco-timeout": "give the fit more time: `--timeout 1200`",
    "memory": "cut the recordings into shorter ones, or fit fewer fields at once",
    "mujoco-crash": "MuJoCo cannot simulate some number in a range: narrow the ranges, or fit fewer fields at once",
}
"""Advice for a fit that MuJoCo does not finish, by the code of the error, or by the kind of crash."""
_OF_READING = frozenset({"recording-column", "recording-unit", "recording-sign", "recording-value", "recording-time"})
"""Faults that a key of `recording` may correct."""

Say = Callable[[str], None]


class FitRequest(Struct):
    """A recipe with values of its parameters, recordings, and how to fit them.

    `name` is the name of the robot. Without `held_out`, a fit holds out the last fifth of a single recording. With
    `curves`, the fit has the curves of its page.
    """

    recipe: Path
    recordings: tuple[Path, ...]
    held_out: tuple[Path, ...] = ()
    given: Given = field(default_factory=dict)
    name: str = "robot"
    window: float | None = None
    from_measured: bool = False
    curves: bool = False


class Fit(Struct):
    """The data of a fit, the text of its file of measurements, and its curves for a page."""

    data: Mapping[str, Any]
    text: str
    curves: Sequence[Mapping[str, Any]] = ()


def identify(request: FitRequest, context: Context, say: Say) -> Fit | None:
    """Return the fit, or None after reported errors. Warnings name the signals that the fit does not explain."""
    with _asked(request, context, say) as asked:
        if asked is None:
            return None
        data = asked.run(fit_recordings)
        if data is None:
            return None
        version = asked.session.mujoco_version or ""
    curves = data.pop("curves")
    text = text_of(request.name, request.recipe, data, version, asked.model.hinges)
    _judge(data, asked.model, context.sink)
    return Fit(data, text, curves)


def plan_fit(request: FitRequest, context: Context, say: Say) -> list[dict[str, Any]] | None:
    """Return the information of the recordings about each number, or None after reported errors."""
    with _asked(request, context, say) as asked:
        if asked is None:
            return None
        data = asked.run(plan_recordings)
        return None if data is None else data["numbers"]


class _Asked(Struct):
    """A question to MuJoCo's process about recordings."""

    model: FitModel
    session: Session
    context: Context
    question: dict[str, Any]
    say: Say

    def run(self, function: Callable[..., Any]) -> dict[str, Any] | None:
        """Return the answer of a function, or None after a reported error."""
        sink = self.context.sink
        with _progress(Path(self.question["progress"]), self.say):
            answer = engine.call(self.session, function, [WHOLE], argument=self.question)
        if not answer.ok:
            code = CRASHES.get(answer.crash or "", "mujoco-crash")
            help = _CRASHED.get(answer.crash or "") or _CRASHED.get(code, CRASH_HELP.get(code))
            sink.error(code, f"the fit ended: {answer.error or answer.crash}", self.model.plan.span, help=help)
            return None
        if "fault" in answer.value:
            report_fault(answer.value["fault"], self.model, sink)
            return None
        data: dict[str, Any] = answer.value
        return data


@contextmanager
def _asked(request: FitRequest, context: Context, say: Say) -> Iterator[_Asked | None]:
    context.as_designed = not request.from_measured
    with Session() as session, scratch("identify") as folder:
        say("building the model")
        model = open_model(request.recipe, request.given, context, session)
        if model is None:
            yield None
            return
        question = question_of(model.identify, model.fields, request.recordings, request.held_out, context)
        question["progress"] = str(folder / "progress")
        if request.window is not None:
            question["window"] = request.window
        question["curves"] = request.curves
        yield _Asked(model, session, context, question, say)


def question_of(
    identify: Identify,
    fields: Sequence[Mapping[str, Any]],
    recordings: Sequence[Path],
    held_out: Sequence[Path],
    context: Context,
) -> dict[str, Any]:
    """Return the question to MuJoCo's process as data."""
    keys = identify.recording
    limits = in_force()

    def named(paths: Sequence[Path]) -> list[dict[str, str]]:
        return [{"path": str(context.folder / path), "file": context.shown(context.folder / path)} for path in paths]

    return {
        "recordings": named(recordings),
        "held_out": named(held_out),
        "splits": True,
        "fields": list(fields),
        "start": identify.start,
        "window": identify.window,
        "limits": {"size": limits.recording_size, "numbers": limits.recording_numbers},
        "keys": {
            "factors": keys.units.factors,
            "dimensions": keys.units.dimensions,
            "percent": list(keys.percent),
            "sign": dict(keys.sign),
            "names": dict(keys.names),
            "ignore": list(keys.ignore),
            "hold": keys.hold,
            "state": keys.state,
            "command": keys.command,
            "command_joints": list(keys.command_joints),
            "clock": keys.clock,
            "episode": keys.episode,
        },
    }


@contextmanager
def _progress(path: Path, say: Say) -> Iterator[None]:
    """Say the lines that MuJoCo's process writes into a file, while it works."""
    done = threading.Event()

    def watch() -> None:
        last = ""
        while not done.wait(_PATIENCE):
            try:
                text = path.read_text(encoding="utf-8")
            except OSError:
                continue
            if text and text != last:
                say(text)
                last = text

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()


def report_fault(fault: Mapping[str, Any], model: FitModel, sink: Sink) -> None:
    """Report a fault of a recording, or of a field, at its place."""
    file = fault["file"]
    if fault["field"] is not None:
        message = f"field `{fault['field']}` of `identify`: {fault['message']}"
        sink.error(fault["code"], message, span_of_field(model, fault["field"]), help=fault["help"])
        return
    span = _span_of_fault(fault, model)
    message = fault["message"] if file is None else f"`{file}`: {fault['message']}"
    sink.error(fault["code"], message, span, help=fault["help"])


def _span_of_fault(fault: Mapping[str, Any], model: FitModel) -> Span | None:
    """Return the line of the recording, or else the key of the recipe that is wrong or that says how to read it."""
    if fault["line"] is not None:
        return Span(fault["file"], fault["line"], 1)
    at = fault["at"] or (("recording",) if fault["code"] in _OF_READING else ())
    return locate(model.plan.document, ("identify", *at), key=True) if at else None


def _judge(data: Mapping[str, Any], model: FitModel, sink: Sink) -> None:
    """Report a fit that follows held-out recordings badly, or whose errors are not noise."""
    for finding in findings_of(data["errors"]):
        report = sink.error if finding.severity == "error" else sink.warning
        report(finding.code, finding.message, model.plan.span, help=finding.help)
