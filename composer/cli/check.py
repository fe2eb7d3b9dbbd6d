"""`mjcompose check`: everything a build would find, and nothing written."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.caching import caching, no_cache_option
from composer.cli.choices import choice_options, chosen_values, named_choices
from composer.cli.counting import counting
from composer.cli.fetching import fetching, fetching_options
from composer.cli.junit import junit_option, suite_of, write_junit
from composer.cli.matrix import cells_options, chosen_cells
from composer.cli.reporting import (
    FINDINGS,
    USAGE,
    arguments,
    exit_code,
    progress,
    report,
    reporting_options,
    say,
    told_by_report,
)  # fmt: skip
from composer.cli.tally import Tally
from composer.cli.timeout import timeout_option

if TYPE_CHECKING:
    from composer.cache.builder import Maker
    from composer.cache.cache import Answer, Cache
    from composer.cache.receipt import Told
    from composer.context import Context
    from composer.diagnostics.junit import Suite
    from composer.document import Node
    from composer.verify.outcome import Outcome


@click.command()
@click.argument("recipes", type=click.Path(path_type=Path), nargs=-1, required=True)
@choice_options
@cells_options
@click.option("--no-verify", is_flag=True, help="Do not compile the models in MuJoCo, nor run their checks.")
@timeout_option
@junit_option
@no_cache_option
@fetching_options
@reporting_options
def command(
    recipes: tuple[Path, ...],
    sets: tuple[str, ...],
    set_files: tuple[Path, ...],
    variants: tuple[str, ...],
    every: bool,
    picks: tuple[str, ...],
    only_samples: tuple[int, ...],
    no_verify: bool,
    timeout: float,
    junit: str | None,
    no_cache: bool,
    form: str,
) -> None:
    """Say whether each of RECIPES is right: read, planned, composed, compiled in MuJoCo, and its checks hold.

    Without --all, --pick or --sample the model of the default values is checked. Nothing is written but what --junit
    asks for.
    """
    from composer.cache.builder import Maker
    from composer.cache.options import Order
    from composer.context import Context

    code = 0
    suites: list[Suite] = []
    told: list[Told] = []
    answers: list[Answer | None] = []
    used: Cache | None = None
    for recipe in recipes:
        how = fetching()
        context = Context(fetching=how)
        given = chosen_values(sets, set_files, variants, context)
        if context.sink.has_errors:
            report(context, form)
            sys.exit(USAGE)
        choices = named_choices(sets, set_files, variants, context)
        order = Order(not no_verify, choices=choices, locked=how.locked, offline=how.offline)
        with caching(context, no_cache) as cache:
            used = cache
            look = _Check(Maker(recipe, order, cache, context), context, timeout, form)
            cells = every or bool(picks) or bool(only_samples)
            if not cells or not look.cells(picks, only_samples, given):
                look.one(given)
            if not cells and not look.code:
                look.count_cells(given)
        report(context, form, err=junit == "-")
        suites += look.suites
        told += told_by_report(context, form)
        answers += look.answers
        if look.tally is not None:
            told += look.tally.say(form, err=junit == "-")
        code = max(code, look.code)
        if not look.code and form == "text" and junit != "-":
            told.append((False, f"{recipe}: ok{look.counted}\n"))
            say(told[-1][1].rstrip("\n"))
    if junit is not None:
        context = Context()
        write_junit(suites, junit, context)
        report(context, form)
        code = max(code, FINDINGS if context.sink.has_errors else 0)
    elif not code and used is not None:
        from composer.cache.receipt import note

        note(used, arguments(), os.environ, answers, set_files, told)
    sys.exit(code)


class _Check:
    """A look at one recipe: at one model or at several."""

    def __init__(self, maker: Maker, context: Context, timeout: float, form: str) -> None:
        self.maker, self.context, self.timeout, self.form = maker, context, timeout, form
        self.suites: list[Suite] = []
        self.answers: list[Answer | None] = []
        self.tally: Tally | None = None
        self.counted = ""
        self.code = 0

    def one(self, given: dict[str, Node]) -> None:
        """Check the one model that the recipe is without a cell."""
        from composer.engine import Limits, Session

        maker, context = self.maker, self.context
        outcomes: list[Outcome] = []
        question = maker.question()
        made, why = maker.recall(question, context, outcomes)
        if made is None:
            progress(f"checking {maker.recipe}")
            with Session(Limits(seconds=self.timeout)) as session:
                made = maker.make(context, session, given, question=question, why=why, outcomes=outcomes)
        self.suites.append(suite_of(maker.recipe, outcomes, context))
        self.answers.append(None if made is None else made.answer)
        self.counted = _counted(len(outcomes))
        self.code = exit_code(context.folder, [maker.recipe]) if made is None else 0

    def cells(self, picks: tuple[str, ...], samples: tuple[int, ...], given: dict[str, Node]) -> bool:
        """Check cells; False where there are none, for the recipe is one model."""
        from composer.cache.cells import made_cells
        from composer.engine import Limits, Session

        maker, context = self.maker, self.context
        chosen, self.code = chosen_cells(maker.recipe, picks, samples, given, context, "check")
        if self.code:
            self.suites.append(suite_of(maker.recipe, (), context))
            return True
        if not chosen:
            return False
        self.tally = Tally(maker.recipe, len(chosen))
        checks = 0
        with Session(Limits(seconds=self.timeout)) as session:
            running = made_cells(maker, chosen, context, given, session)
            for each in counting(running, len(chosen), lambda each: each.cell.name):
                found = each.context.sink.diagnostics
                self.tally.take(each.cell.label, found, context.sink, failed=each.failed)
                self.suites.append(suite_of(maker.recipe, each.outcomes, each.context, each.cell.label))
                self.answers.append(None if each.made is None else each.made.answer)
                checks += len(each.outcomes)
        self.counted = f", {len(chosen)} model{'s' * (len(chosen) > 1)}{_counted(checks)}"
        self.code = FINDINGS if self.tally.failed else 0
        return True

    def count_cells(self, given: dict[str, Node]) -> None:
        """Say what was not checked: the cells of the matrix."""
        from composer.cache.cells import cells_of
        from composer.diagnostics.sink import Sink

        cells = cells_of(self.maker.recipe, replace(self.context, sink=Sink()), given)
        names = {each.cell for each in cells if each.cell is not None}
        if names:
            count = f"{len(names)} cell{'s' * (len(names) > 1)}"
            self.context.sink.note("cells-not-checked", f"one model was checked, and the matrix has {count}",
                                   cells[0].span, help="`--all` checks all of them, `--pick CELL` one")  # fmt: skip


def _counted(checks: int) -> str:
    if not checks:
        return ""
    return f", {checks} check{'s hold' if checks > 1 else ' holds'}"
