"""`mjcompose build --all` and `--pick`: the cells of a recipe's matrix, and the samples of what it draws."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

import click

from composer.build.cells import build_cells as built_cells
from composer.build.cells import cells_of, picked
from composer.build.sample_table import FILE, SampleTable
from composer.bundle.output_error import OutputError
from composer.cli.build import build_one, finish, put
from composer.cli.built_words import said
from composer.cli.counting import counting
from composer.cli.reporting import FINDINGS, INTERRUPTED, USAGE, arguments, report
from composer.cli.wanted import Wanted, kind_of_output

if TYPE_CHECKING:
    from composer.build.maker import Maker
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session


def build_cells(
    maker: Maker,
    wanted: Wanted,
    given: dict[str, Node],
    picks: tuple[str, ...],
    context: Context,
    session: Session,
    table: str | None = None,
) -> int:
    """Build them one after another; what is at fault in several is told once. Gives the exit code.

    What was drawn goes to `table`; without one, beside the models where all are built.
    """
    recipe = maker.recipe
    every = cells_of(recipe, context, given)
    if not every and not context.sink.has_errors:
        if not picks:
            made, why = maker.recall(maker.question(), context)
            if made is not None:
                return finish(made, maker, wanted, context, session)
            return build_one(maker, wanted, given, context, session, why)
        context.sink.error("missing-key", f"`{recipe}` has neither `matrix` nor `randomize`: it is one model",
                           help="build it without `--pick`")  # fmt: skip
    chosen = picked(every, picks, context.sink) if picks else every
    for name in dict.fromkeys(name for cell in chosen for name in cell.given if name in given):
        context.sink.error("unknown-name", f"`{name}` is an axis of the matrix, whose cells set it",
                           help="do not set it, or build without `--all` and `--pick`")  # fmt: skip
    if context.sink.has_errors:
        report(context, wanted.form)
        return USAGE if chosen and not picks else FINDINGS
    try:
        kind_of_output(wanted.out, many=len(chosen) > 1)
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
        report(context, wanted.form)
        return USAGE
    failed: list[str] = []
    running = built_cells(maker, chosen, context, given, session)
    samples = SampleTable()
    whole = 0
    try:
        for cell, own, made in counting(running, len(chosen), lambda each: each[0].name):
            made = None if made is None else put(made, maker, wanted, own, session)
            for diagnostic in own.sink.diagnostics:
                context.sink.add(diagnostic)
            if made is None or own.sink.has_errors:
                failed.append(cell.name)
            else:
                whole += 1
                click.echo(said(made, wanted))
                if made.draws is not None:
                    samples.add(cell.name, cell.sample, made.draws)
    except (KeyboardInterrupt, SystemExit) as ended:
        click.echo(_how_to_go_on(whole, len(chosen), maker), err=True)
        return ended.code if isinstance(ended, SystemExit) and isinstance(ended.code, int) else INTERRUPTED
    finally:  # of an interrupted run too
        _put_table(samples, table or (None if picks else _beside(wanted.out)), wanted.form, context)
    report(context, wanted.form)
    if failed and wanted.form == "text":
        click.echo(f"{len(failed)} of {len(chosen)} cells failed: {', '.join(failed)}", err=True)
    return FINDINGS if failed or context.sink.has_errors else 0


def _beside(out: str) -> str:
    """The table in the folder in which every model has its own name."""
    folder = out.partition("{name}")[0].rpartition("/")[0]
    return f"{folder}/{FILE}" if folder or out.startswith("/") else FILE


def _put_table(samples: SampleTable, path: str | None, form: str, context: Context) -> None:
    if path is not None and samples.count:
        try:
            samples.write(context.folder / path)
        except OutputError as error:
            context.sink.error(error.code, error.message, help=error.help)
        else:
            if form == "text":
                click.echo(f"wrote {path}: what was drawn for {samples.count} models")
    samples.close()


def _how_to_go_on(whole: int, total: int, maker: Maker) -> str:
    command = shlex.join(["mjcompose", *arguments()])
    rest = "builds the rest" if maker.cache is not None else "builds them all"
    return f"interrupted: {whole} of {total} are written and whole; `{command}` {rest}"
