"""`mjcompose diff`: what is different between two models, in physics terms."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from composer.cli.amount import Amount
from composer.cli.choices import Choices, choice_options
from composer.cli.matrix import pick_option
from composer.cli.reporting import (
    USAGE,
    clear_progress,
    format_options,
    progress,
    quiet_option,
    report,
)  # fmt: skip
from composer.cli.timeout import timeout_option

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
@pick_option
@click.option("--only", multiple=True, type=click.Choice(_KINDS), metavar="KIND",
              help="Compare this kind of element, or `option`, `visual`, `statistic`, `count`, `address`.")  # fmt: skip
@click.option("--tolerance", type=Amount(min=0), default=0.0, show_default=True,
              help="Numbers that differ by a smaller share than this count as the same.")  # fmt: skip
@click.option("--computed", is_flag=True, help="List also numbers that MuJoCo computes from others.")
@click.option("--all", is_flag=True, hidden=True, expose_value=False, is_eager=True, callback=_no_all)
@click.option("--renders", type=click.Path(path_type=Path, file_okay=False), metavar="DIR",
              help="Put pictures of both here: of the whole, and of every camera that both have.")  # fmt: skip
@timeout_option
@format_options(_FORMATS)
@quiet_option
def command(
    a: str,
    b: str,
    choices: Choices,
    pick: str | None,
    only: tuple[str, ...],
    tolerance: float,
    computed: bool,
    renders: Path | None,
    timeout: float,
    form: str,
) -> None:
    """Tell what changes from model A to model B, by the line that is the reason.

    A and B are recipes, MJCF files or bundles (folder, .zip, .mjz), here or in a git revision: `main:arm.yaml`.
    Exit codes: 0 the same, 1 different, 2 one of them cannot be read or built.
    """
    from composer.context import Context
    from composer.diff.data import as_data
    from composer.diff.diff import diff
    from composer.diff.markdown import render as in_markdown
    from composer.diff.text import render as in_text
    from composer.engine import Limits, Session

    context = Context()
    given = choices.values(context)
    found = None
    if not context.sink.has_errors:
        progress(f"comparing {a} with {b}")
        with Session(Limits(seconds=timeout), rendering=renders is not None) as session:
            found = diff(
                a, b, context, session, tolerance=tolerance, only=only, everything=computed, given=given,
                pick=pick, renders=renders,
            )  # fmt: skip
    if found is None:
        report(context, "json" if form == "json" else "text")
        sys.exit(USAGE)
    clear_progress()
    if form == "json":
        click.echo(json.dumps(as_data(found), indent=2, ensure_ascii=False))
    elif form == "markdown":
        click.echo(in_markdown(found), nl=False)
    else:
        click.echo(in_text(found))
    sys.exit(0 if found.same else _DIFFERENT)
