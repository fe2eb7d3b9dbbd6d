"""`mjcompose build --all` and `--pick`: the cells of a recipe's matrix, and the samples of what it draws."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

import click

from composer.bundle.output_error import OutputError
from composer.cache.cells import made_cells
from composer.cache.sample_table import FILE, SampleTable
from composer.cli.built_words import said
from composer.cli.counting import counting
from composer.cli.matrix import chosen_cells
from composer.cli.reporting import FINDINGS, INTERRUPTED, USAGE, arguments, report, say
from composer.cli.tally import Tally
from composer.cli.wanted import Wanted, kind_of_output
from composer.cli.writing import build_one, finish, put

if TYPE_CHECKING:
    from composer.cache.builder import Maker
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session


def build_cells(
    maker: Maker,
    wanted: Wanted,
    given: dict[str, Node],
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    context: Context,
    session: Session,
    table: str | None = None,
) -> int:
    """Build them one after another; what is at fault in several is told once. Gives the exit code.

    What was drawn goes to `table`; without one, beside the models where all are built.
    """
    recipe = maker.recipe
    chosen, code = chosen_cells(recipe, picks, only_samples, given, context, "build")
    if code:
        report(context, wanted.form)
        return code
    if not chosen:
        made, why = maker.recall(maker.key(), context)
        if made is not None:
            return finish(made, maker, wanted, context, session)
        return build_one(maker, wanted, given, context, session, why)
    try:
        kind_of_output(wanted.out, len(chosen))
    except OutputError as error:
        context.sink.add(error.diagnostic)
        report(context, wanted.form)
        return USAGE
    tally = Tally(recipe, len(chosen))
    running = made_cells(maker, chosen, context, given, session)
    samples = SampleTable()
    try:
        for each in counting(running, len(chosen), lambda each: each.cell.name):
            cell, own = each.cell, each.context
            made = None if each.made is None else put(each.made, maker, wanted, own, session)
            tally.take(
                cell.label, own.sink.diagnostics, context.sink, failed=made is None or own.sink.has_errors
            )
            if made is not None and not own.sink.has_errors:
                say(said(made, wanted), form=wanted.form)
                if made.draws is not None:
                    samples.add(cell.name, cell.sample, made.draws)
    except (KeyboardInterrupt, SystemExit) as ended:
        click.echo(_how_to_go_on(tally.whole, len(chosen), maker), err=True)
        return ended.code if isinstance(ended, SystemExit) and isinstance(ended.code, int) else INTERRUPTED
    finally:  # of an interrupted run too
        _put_table(
            samples, table or (None if picks or only_samples else _beside(wanted.out)), wanted.form, context
        )
    report(context, wanted.form)
    tally.say(wanted.form)
    return FINDINGS if context.sink.has_errors else 0


def _beside(out: str) -> str:
    """The table in the folder in which every model has its own name."""
    folder = out.partition("{name}")[0].rpartition("/")[0]
    return f"{folder}/{FILE}" if folder or out.startswith("/") else FILE


def _put_table(samples: SampleTable, path: str | None, form: str, context: Context) -> None:
    if path is not None and samples.count:
        try:
            samples.write(context.folder / path)
        except OutputError as error:
            context.sink.add(error.diagnostic)
        else:
            if form == "text":
                say(f"wrote {path}: what was drawn for {samples.count} models")
    samples.close()


def _how_to_go_on(whole: int, total: int, maker: Maker) -> str:
    command = shlex.join(["mjcompose", *arguments()])
    rest = "builds the rest" if maker.cache is not None else "builds them all"
    return f"interrupted: {whole} of {total} are written and whole; `{command}` {rest}"
