"""`mjcompose identify`: fit the numbers of a recipe to recordings of a robot."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base.files import open_regular
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import check_is_no_source, resolved_output, staged_file
from mjcompose.cli.options import RECIPE, Choices, FetchOptions, ReportOptions, TimeOptions, output
from mjcompose.cli.reporting import progress_of_command
from mjcompose.cli.run import PATH, Answer, Group, Run, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.tools.identify.identify import FitRequest


_START = 1 << 14
_MEASURED = re.compile(rb"^measured: *[0-9]", re.MULTILINE)


class IdentifyOptions(Group):
    recipe: Path = RECIPE
    recordings: tuple[Path, ...] = argument(metavar="RECORDING...", type=PATH, nargs=-1, required=True)
    out: str | None = output("The file of measurements to write, such as robots/A12.yaml.")
    held_out: tuple[Path, ...] = option(
        "--hold-out",
        metavar="RECORDING",
        type=PATH,
        multiple=True,
        help="Do not fit this recording: compare it with the result. Without this option, the command holds out the "
        "last fifth of a single RECORDING.",
    )
    plan: bool = flag("--plan", help="Fit nothing: show how well the recordings determine each number.")
    report: Path | None = option(
        "--report",
        type=click.Path(path_type=Path, dir_okay=False),
        metavar="FILE",
        help="Write a page about the fit: its verdict, curves of recording and model, the numbers, their correlations.",
    )
    window: float | None = option(
        "--window",
        type=click.FloatRange(min=0.05),
        metavar="SECONDS",
        help="Compare recordings in pieces of this length.",
    )
    name: str | None = option("--name", help="The name of the robot in the file. The default is the name of OUT.")
    from_measured: bool = flag(
        "--from-measured", help="Start from the numbers of the recipe's file of measurements, instead of its own."
    )
    choices: Choices = group(Choices)
    fetching: FetchOptions = group(FetchOptions)
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    IdentifyOptions,
    help="""Fit the numbers of the section `identify` of RECIPE to each RECORDING of a robot: `.csv`, `.npz`,
    `.parquet`, `.mcap` of ROS 2, or the folder of a data set of LeRobot.

    The result is a file of measurements, which `measured: FILE` in a recipe uses. Columns are called `time`, `qpos
    JOINT`, `qvel JOINT`, `ctrl ACTUATOR` and `sensor NAME`. Exit codes: 1 if a recording or a field is wrong, or if the
    result follows a held-out recording worse than the recipe.
    """,
)
def identify(options: IdentifyOptions, run: Run) -> Answer:
    from mjcompose.tools.identify.identify import FitRequest, identify, plan_fit
    from mjcompose.tools.identify.page import page_of

    _check_options(options)
    name = options.name or (Path(options.out).stem if options.out else options.recipe.stem)
    request = FitRequest(
        options.recipe,
        options.recordings,
        options.held_out,
        options.choices.given(run),
        name=name,
        window=options.window,
        from_measured=options.from_measured,
        curves=options.report is not None,
    )
    with run.context.sink:
        if options.out is not None:
            _check_output(Path(options.out), request)
        if options.report is not None:
            check_is_no_source(options.report, "--report", _inputs(request))
    run.need(None if run.context.sink.has_errors else request, options.recipe)
    if options.plan:
        return _plan(request, run, plan_fit(request, run.context, progress_of_command()))
    fit = run.need(identify(request, run.context, progress_of_command()), options.recipe)
    lines = [*_lines(fit.data)]
    if options.out is not None and not run.context.sink.has_errors:
        with run.context.sink:
            _write(Path(options.out), "-o", fit.text, request)
            lines.append(f"wrote {options.out}")
    if options.report is not None:  # also of a fit that is an error: it shows why
        with run.context.sink:
            _write(options.report, "--report", page_of(name, options.recipe.name, fit.data, fit.curves), request)
            lines.append(f"wrote {options.report}: open it in a browser")
    return Answer("\n".join(lines), dict(fit.data))


def _check_options(options: IdentifyOptions) -> None:
    if options.plan and options.report is not None:
        raise click.UsageError("--report is the page of a fit, and --plan fits nothing.")
    if options.plan and options.out is not None:
        raise click.UsageError("-o is the file of a fit, and --plan fits nothing.")
    if (
        options.out is not None
        and options.report is not None
        and resolved_output(options.report) == resolved_output(Path(options.out))
    ):
        raise click.UsageError("-o and --report are the same file.")


def _inputs(request: FitRequest) -> list[Path]:
    return [request.recipe, *request.recordings, *request.held_out]


def _check_output(out: Path, request: FitRequest) -> None:
    """Refuse, before the fit, to replace an input, or another file than a file of measurements."""
    check_is_no_source(out, "-o", _inputs(request))
    try:
        with open_regular(out, is_source=False) as file:
            start = file.read(_START)
    except OSError:
        return  # writing it says why it cannot be replaced
    if start and not _MEASURED.search(start):
        message = f"`{out}` exists, and is not a file of measurements"
        raise OutputError("output-unwritable", message, "choose another output, or remove the file")


def _write(out: Path, option: str, text: str, request: FitRequest) -> None:
    try:
        with staged_file(out, option, inputs=_inputs(request)) as stage:
            stage.write_text(text, encoding="utf-8")
    except OSError as error:
        raise OutputError("output-unwritable", f"`{out}` cannot be written: {error.strerror or error}") from None


def _plan(request: FitRequest, run: Run, numbers: list[dict[str, Any]] | None) -> Answer:
    from mjcompose.tools.identify.words import number_words

    found = run.need(numbers, request.recipe)
    width = max(len(number_words(number)) for number in found)
    lines = [
        f"{number_words(number):{width}}  ± {number['prior']:<8.3g} now, ± {number['std']:<8.3g} after"
        + (", little is learned" if number["little"] else "")
        for number in found
    ]
    return Answer("\n".join(line.rstrip() for line in lines), {"numbers": found})


def _lines(data: Mapping[str, Any]) -> Iterator[str]:
    from mjcompose.tools.identify.words import error_words, half_interval, number_words, verdict_words

    count = counted(len(data["numbers"]), "number")
    yield f"{count} in {data['seconds']:.0f} s, {data['simulated_steps']} simulated steps"
    width = max(len(number_words(number)) for number in data["numbers"])
    for number in data["numbers"]:
        words = verdict_words(number["verdict"])
        verdict = f"  {words}: {number['reason']}" if words else ""
        value = f"{number['value']:10.5g} ± {half_interval(number):<9.2g}"
        yield f"  {number_words(number):{width}}  {value} recipe {number['recipe']:<9.4g}{verdict}".rstrip()
    width = max(len(error["signal"]) for error in data["errors"])
    for error in data["errors"]:
        yield f"  {error['signal']:{width}}  {error_words(error)}"
