"""`mjcompose build --all` and `--pick`: the cells of a recipe's matrix."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.build.cells import build_cells as built_cells
from composer.build.cells import cells_of, picked
from composer.cli.build import Wanted, build_one, put, say
from composer.cli.counting import counting
from composer.cli.reporting import FINDINGS, USAGE, report

if TYPE_CHECKING:
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session


def build_cells(
    recipe: Path,
    wanted: Wanted,
    given: dict[str, Node],
    picks: tuple[str, ...],
    context: Context,
    session: Session,
) -> int:
    """Build them one after another; what is at fault in several is told once. Gives the exit code."""
    every = cells_of(recipe, context)
    if not every and not context.sink.has_errors:
        if not picks:
            return build_one(recipe, wanted, given, context, session)
        context.sink.error("missing-key", f"`{recipe}` has no `matrix`: it is one model",
                           help="build it without `--pick`")  # fmt: skip
    chosen = picked(every, picks, context.sink) if picks else every
    for name in dict.fromkeys(name for cell in chosen for name in cell.given if name in given):
        context.sink.error("unknown-name", f"`{name}` is an axis of the matrix, whose cells set it",
                           help=f"take `--set {name}=…` out, or build without `--all` and `--pick`")  # fmt: skip
    if context.sink.has_errors:
        report(context, wanted.form)
        return USAGE if chosen and not picks else FINDINGS
    failed: list[str] = []
    running = built_cells(recipe, chosen, context, given, verified=wanted.verified,
                          deduplicated=wanted.deduplicated, session=session)  # fmt: skip
    for cell, own, built in counting(running, len(chosen), lambda each: each[0].name):
        target = None if built is None else put(built, wanted, own, session)
        for diagnostic in own.sink.diagnostics:
            context.sink.add(diagnostic)
        if built is None or target is None or own.sink.has_errors:
            failed.append(cell.name)
        else:
            say(built, target, wanted, own)
    report(context, wanted.form)
    if failed and wanted.form == "text":
        click.echo(f"{len(failed)} of {len(chosen)} cells failed: {', '.join(failed)}", err=True)
    return FINDINGS if failed else 0
