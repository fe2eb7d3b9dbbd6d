"""`mjcompose check`: everything a build would find, and nothing written."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.caching import caching, no_cache_option
from composer.cli.choices import Choices, choice_options
from composer.cli.counting import counting
from composer.cli.fetching import fetching, fetching_options
from composer.cli.junit import junit_option, suite_of, write_junit
from composer.cli.matrix import cells_options, chosen_cells
from composer.cli.reporting import FINDINGS, USAGE, exit_code, progress, report, reporting_options, say
from composer.cli.tally import Tally
from composer.cli.timeout import timeout_option

if TYPE_CHECKING:
    from composer.cache.builder import Maker
    from composer.cache.result import Made
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
    choices: Choices,
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
    from composer.cache.cache_key import BuildOptions
    from composer.context import Context

    code = 0
    suites: list[Suite] = []
    for recipe in recipes:
        how = fetching()
        context = Context(fetching=how)
        given = choices.values(context)
        if context.sink.has_errors:
            report(context, form)
            sys.exit(USAGE)
        order = BuildOptions(
            not no_verify, choices=choices.named(context), locked=how.locked, offline=how.offline
        )
        with caching(context, no_cache) as cache:
            look = _Check(Maker(recipe, order, cache, context), context, timeout, form)
            if not (every or picks or only_samples):
                look.one(given, alone=True)
            elif not look.cells(picks, only_samples, given):
                look.one(given)
        report(context, form, err=junit == "-")
        suites += look.suites
        if look.tally is not None:
            look.tally.say(form, err=junit == "-")
        code = max(code, look.code)
        if not look.code and form == "text" and junit != "-":
            say(f"{recipe}: ok{look.counted}")
    if junit is not None:
        context = Context()
        write_junit(suites, junit, context)
        report(context, form)
        code = max(code, FINDINGS if context.sink.has_errors else 0)
    sys.exit(code)


class _Check:
    """A look at one recipe: at one model or at several."""

    def __init__(self, maker: Maker, context: Context, timeout: float, form: str) -> None:
        self.maker, self.context, self.timeout, self.form = maker, context, timeout, form
        self.suites: list[Suite] = []
        self.tally: Tally | None = None
        self.counted = ""
        self.code = 0

    def one(self, given: dict[str, Node], *, alone: bool = False) -> None:
        """Check the one model that the recipe is without a cell; `alone` says that nobody asked for the cells."""
        maker, context = self.maker, self.context
        outcomes: list[Outcome] = []
        key = maker.key()
        made, why = maker.recall(key, context, outcomes)
        if made is None:
            from composer.engine import Limits, Session

            progress(f"checking {maker.recipe}")
            with Session(Limits(seconds=self.timeout)) as session:
                made = maker.make(context, session, given, key=key, why=why, outcomes=outcomes)
        self.suites.append(suite_of(maker.recipe, outcomes, context))
        self.counted = _counted(len(outcomes))
        self.code = exit_code(context.folder, [maker.recipe]) if made is None else 0
        if made is not None and alone:
            self._tell_cells(made)

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
                checks += len(each.outcomes)
        self.counted = f", {len(chosen)} model{'s' * (len(chosen) > 1)}{_counted(checks)}"
        self.code = FINDINGS if self.tally.failed else 0
        return True

    def _tell_cells(self, made: Made) -> None:
        """Say what was not checked: the cells of the matrix."""
        if made.cells:
            count = f"{made.cells} cell{'s' * (made.cells > 1)}"
            self.context.sink.note("cells-not-checked", f"one model was checked, and the matrix has {count}",
                                   made.cells_at, help="`--all` checks all of them, `--pick CELL` one")  # fmt: skip


def _counted(checks: int) -> str:
    if not checks:
        return ""
    return f", {checks} check{'s hold' if checks > 1 else ' holds'}"
