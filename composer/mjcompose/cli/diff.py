"""`mjcompose diff`: the differences between two models, in physics terms."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.report import printable
from mjcompose.cli.options import Amount, Choices, cell_options, choice_options, timeout_option
from mjcompose.cli.reporting import (
    USAGE,  # fmt: skip
    clear_progress,  # fmt: skip
    format_options,  # fmt: skip
    progress,  # fmt: skip
    quiet_option,  # fmt: skip
    report,  # fmt: skip
    say,  # fmt: skip
)

if TYPE_CHECKING:
    from mjcompose.tools.diff.changes import Diff
    from mjcompose.tools.diff.sides import Side

_DIFFERENT = 1
_FORMATS = ("text", "json", "markdown")
_KINDS = (
    "body joint geom site camera light texture material mesh hfield skin flex tendon equality pair exclude actuator"
    " sensor numeric text tuple plugin key option visual statistic count address"
).split()


def _no_all(_context: click.Context, _option: click.Parameter, wanted: bool) -> None:
    if wanted:
        raise click.UsageError(
            "No such option '--all'. '--computed' lists also numbers that MuJoCo computes from others; "
            "'--pick CELL' compares one cell of a matrix."
        )


@click.command()
@click.argument("a")
@click.argument("b")
@choice_options
@cell_options
@click.option("--only", multiple=True, type=click.Choice(_KINDS), metavar="KIND",
              help="Compare only this kind of element, or `option`, `visual`, `statistic`, `count`,"
              " `address`.")  # fmt: skip
@click.option("--tolerance", type=Amount(min=0), default=0.0, show_default=True,
              help="Treat numbers as equal if their relative difference is smaller than this.")  # fmt: skip
@click.option("--computed", is_flag=True, help="Also list numbers that MuJoCo computes from others.")
@click.option("--all", is_flag=True, hidden=True, expose_value=False, is_eager=True, callback=_no_all)
@click.option("--renders", type=click.Path(path_type=Path, file_okay=False), metavar="DIR",
              help="Write pictures of both models here: of the whole model, and from each camera that"
              " both have.")  # fmt: skip
@click.option("--html", type=click.Path(path_type=Path, dir_okay=False), metavar="FILE",
              help="Write an HTML page that shows both models, with the differences in colour.")  # fmt: skip
@timeout_option
@format_options(_FORMATS)
@quiet_option
def command(
    a: str,
    b: str,
    choices: Choices,
    pick: str | None,
    sample: int | None,
    only: tuple[str, ...],
    tolerance: float,
    computed: bool,
    renders: Path | None,
    html: Path | None,
    form: str,
) -> None:
    """Report the differences between model A and model B, grouped by the line that causes them.

    A and B are recipes, MJCF files or bundles (folder, .zip, .mjz). They may be in a git revision: `main:arm.yaml`.
    Exit codes: 0 no difference, 1 differences, 2 a model cannot be read or built.
    """
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context
    from mjcompose.tools.diff.diff import diff
    from mjcompose.tools.diff.text import as_data
    from mjcompose.tools.diff.text import render as in_text
    from mjcompose.tools.diff.text import render_markdown as in_markdown

    context = Context()
    given = choices.values(context)
    found = None

    def show(first: Side, second: Side, compared: Diff) -> None:
        from mjcompose.tools.view.page import write_comparison

        if html is not None:
            write_comparison(first, second, compared, out=html, context=context, session=session)

    if not context.sink.has_errors:
        progress(f"comparing {a} with {b}")
        with Session(rendering=renders is not None) as session:
            found = diff(
                a, b, context, session=session, tolerance=tolerance, only=only, everything=computed, given=given,
                pick=pick, sample=sample, renders=renders, show=show,
            )  # fmt: skip
    if found is None:
        report(context, "json" if form == "json" else "text")
        sys.exit(USAGE)
    clear_progress()
    if form == "json":
        click.echo(json.dumps(as_data(found), indent=2))
    elif form == "markdown":
        click.echo(in_markdown(found), nl=False)
    else:
        click.echo(printable(in_text(found), colors=True))
    if html is not None:
        say(f"wrote {html}: open it in a browser", err=True, form="text")
    sys.exit(0 if found.same else _DIFFERENT)
