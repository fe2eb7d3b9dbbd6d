"""`mjcompose upgrade`: how a model moves in another version of MuJoCo."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.files import RECIPES
from mjcompose.base.report import counted
from mjcompose.cli import completion
from mjcompose.cli.options import Amount, FetchOptions, ReportOptions, TimeOptions
from mjcompose.cli.reporting import FINDINGS, progress
from mjcompose.cli.run import PATH, Answer, Group, Run, Stop, argument, command, group, option

if TYPE_CHECKING:
    from mjcompose.tools.migrate.upgrade import Upgrade


class Options(Group):
    model: str = argument(shell_complete=completion.files)
    before: str = option("--from", metavar="VERSION", required=True, help="The MuJoCo version that you use now.")
    after: str | None = option(
        "--to", metavar="VERSION", help="The MuJoCo version to use.  [default: the installed one]"
    )
    seconds: float = option("--seconds", type=Amount(0, 60, min_open=True), default=2.0, show_default=True,
                            help="The length of each simulation.")  # fmt: skip
    tolerance: float = option("--tol", type=Amount(0), default=1e-3, show_default=True,
                              help="The distance up to which motions are the same, in m or rad.")  # fmt: skip
    key: str | None = option("--key", help="The keyframe to hold, step and drop from.  [default: the first one]")
    pythons: tuple[Path, ...] = option("--with-python", multiple=True, metavar="PATH", type=PATH,
                                       help="A Python with one of the two versions.")  # fmt: skip
    fetching: FetchOptions = group(FetchOptions)
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def upgrade(options: Options, run: Run) -> Answer:
    """Show how MODEL, an MJCF file, moves differently in another version of MuJoCo, and which line causes it.

    Four trials run in both versions: the model settles from its reference configuration, holds a keyframe, gets a step
    of all controls, and drops without actuators. Missing versions are installed into environments of their own.

    Exit codes: 0 the model moves alike, 1 something moves differently or fails, 2 wrong usage.
    """
    from mjcompose.tools.migrate.upgrade import Request
    from mjcompose.tools.migrate.upgrade import upgrade as upgraded

    if Path(options.model).suffix.lower() in RECIPES:
        help = f"in the recipe, write `check: {{moves: {{moves_alike: mujoco=={options.before}}}}}`"
        raise click.UsageError(f"{options.model} is a recipe: {help}")
    request = Request(
        options.model, options.before, options.after, seconds=options.seconds, tolerance=options.tolerance,
        key=options.key, pythons=options.pythons,
    )  # fmt: skip
    found = upgraded(request, run.context, progress)
    if found is None:
        raise Stop(run.code_of_failure(Path(options.model)))
    data = {
        "model": options.model, "from": found.before, "to": found.after, "trials": list(found.trials),
        "moved": [each.data() for each in found.moved], "diverged": list(found.diverged),
    }  # fmt: skip
    code = FINDINGS if found.moved or found.diverged else 0
    return Answer("\n".join(_lines(options, found)), data, code=code, is_outcome=True)


def _lines(options: Options, found: Upgrade) -> Iterator[str]:
    way = f"from MuJoCo {found.before} to {found.after}"
    trials = ", ".join(found.trials)
    if not found.moved:
        yield f"{options.model} moves alike {way}, within {options.tolerance:g} m or rad, in {trials}"
    else:
        yield f"{options.model} {way}: {counted(len(found.moved), 'difference')} in {trials}"
    for each in found.moved:
        yield f"  {each.moved.words}"
        for step in each.steps:
            yield f"    cause: {step.span or options.model}: {step.change}, which `migrate` undoes: {step.words}"
        for meaning in each.suspects:
            yield f"    perhaps: {meaning.span or options.model}: {meaning.change}: {meaning.message}"
        if not each.steps and not each.suspects:
            yield "    cause: no line of the model; MuJoCo solves or collides in another way"
    for trial in found.diverged:
        yield f"  the simulation diverges in `{trial}`"
