"""`mjcompose diff`: the differences between two models, in physics terms."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.cells import CellOptions
from mjcompose.cli.options import Amount, Choices, ReportOptions, TimeOptions
from mjcompose.cli.reporting import USAGE, progress
from mjcompose.cli.run import Answer, Run, Stop, argument, command, flag, group, option

if TYPE_CHECKING:
    from mjcompose.tools.diff.changes import Diff
    from mjcompose.tools.diff.sides import Side

_DIFFERENT = 1
_KINDS = (
    "body joint geom site camera light texture material mesh hfield skin flex tendon equality pair exclude actuator"
    " sensor numeric text tuple plugin key option visual statistic count address"
).split()


def _no_all(_context: click.Context, _option: click.Parameter, is_given: bool) -> None:
    if is_given:
        raise click.UsageError(
            "No such option '--all'. '--computed' lists also numbers that MuJoCo computes from others; "
            "'--pick CELL' compares one cell of a matrix."
        )


@dataclass(frozen=True, slots=True)
class Options:
    a: str = argument()
    b: str = argument()
    choices: Choices = group(Choices)
    cell: CellOptions = group(CellOptions)
    only: tuple[str, ...] = option("--only", multiple=True, type=click.Choice(_KINDS), metavar="KIND",
                                   help="Compare only this kind of element, or `option`, `visual`, `statistic`,"
                                   " `count`, `address`.")  # fmt: skip
    tolerance: float = option("--tolerance", type=Amount(min=0), default=0.0, show_default=True,
                              help="Treat numbers as equal if their relative difference is smaller than"
                              " this.")  # fmt: skip
    computed: bool = flag("--computed", help="Also list numbers that MuJoCo computes from others.")
    all: None = option("--all", is_flag=True, hidden=True, is_eager=True, callback=_no_all)
    renders: Path | None = option("--renders", type=click.Path(path_type=Path, file_okay=False), metavar="DIR",
                                  help="Write pictures of both models here: of the whole model, and from each camera"
                                  " that both have.")  # fmt: skip
    html: Path | None = option("--html", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE",
                               help="Write an HTML page that shows both models, with the differences in"
                               " color.")  # fmt: skip
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def diff(options: Options, run: Run) -> Answer:
    """Report the differences between model A and model B, grouped by the line that causes them.

    A and B are recipes, MJCF files or bundles (folder, .zip, .mjz). They may be in a git revision: `main:arm.yaml`.
    Exit codes: 0 no difference, 1 differences, 2 a model cannot be read or built.
    """
    from mjcompose.mujoco.engine import Session
    from mjcompose.tools.diff.diff import diff
    from mjcompose.tools.diff.text import as_data, render, render_markdown

    context = run.context

    def show(first: Side, second: Side, compared: Diff) -> None:
        from mjcompose.tools.view.page import write_comparison

        if options.html is not None:
            write_comparison(first, second, compared, out=options.html, context=context, session=session)

    given = options.choices.given(run)
    progress(f"comparing {options.a} with {options.b}")
    with Session(rendering=options.renders is not None) as session:
        found = diff(
            options.a, options.b, context, session=session, tolerance=options.tolerance, only=options.only,
            everything=options.computed, given=given, pick=options.cell.pick, sample=options.cell.sample,
            renders=options.renders, show=show,
        )  # fmt: skip
    if found is None:
        raise Stop(USAGE)

    return Answer(
        lambda: render(found),
        lambda: as_data(found),
        markdown=lambda: render_markdown(found).removesuffix("\n"),
        code=0 if found.same else _DIFFERENT,
        reports=False,
        aside=None if options.html is None else f"wrote {options.html}: open it in a browser",
    )
