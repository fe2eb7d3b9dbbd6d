"""`mjcompose check`: everything a build would find, and nothing written."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.caching import caching, no_cache_option
from composer.cli.choices import choice_options, chosen_values, named_choices
from composer.cli.fetching import fetching, fetching_options
from composer.cli.junit import junit_option, suite_of, write_junit
from composer.cli.reporting import (
    FINDINGS,
    arguments,
    progress,
    report,
    reporting_options,
    told_by_report,
)  # fmt: skip

if TYPE_CHECKING:
    from composer.build.cache import Answer, Cache
    from composer.build.receipt import Told
    from composer.verify.outcome import Outcome


@click.command()
@click.argument("recipes", type=click.Path(path_type=Path), nargs=-1, required=True)
@choice_options
@click.option("--no-verify", is_flag=True, help="Do not compile the models in MuJoCo, nor run their checks.")
@junit_option
@no_cache_option
@fetching_options
@reporting_options
def command(
    recipes: tuple[Path, ...],
    sets: tuple[str, ...],
    set_files: tuple[Path, ...],
    variants: tuple[str, ...],
    no_verify: bool,
    junit: str | None,
    no_cache: bool,
    form: str,
    as_json: bool,
) -> None:
    """Say whether each of RECIPES is right: read, planned, composed, compiled in MuJoCo, and its checks hold.

    Nothing is written but what --junit asks for.
    """
    from composer.build.maker import Maker
    from composer.build.order import Order
    from composer.context import Context

    form = "json" if as_json else form
    wrong = False
    suites = []
    told: list[Told] = []
    answers: list[Answer | None] = []
    used: Cache | None = None
    for recipe in recipes:
        how = fetching()
        context = Context(fetching=how)
        choices = named_choices(sets, set_files, variants, context)
        order = Order(not no_verify, choices=choices, locked=how.locked, offline=how.offline)
        outcomes: list[Outcome] = []
        with caching(context, no_cache) as cache:
            used = cache
            maker = Maker(recipe, order, cache, context)
            question = maker.question()
            made, why = maker.recall(question, context, outcomes)
            if made is None:
                given = chosen_values(sets, set_files, variants, context)
                progress(f"checking {recipe}")
                made = maker.make(context, None, given, question=question, why=why, outcomes=outcomes)
        report(context, form, err=junit == "-")
        wrong |= made is None
        suites.append(suite_of(recipe, outcomes, context))
        told += told_by_report(context, form)
        answers.append(None if made is None else made.answer)
        if made is not None and form == "text" and junit != "-":
            told.append((False, f"{recipe}: ok{_counted(outcomes)}\n"))
            click.echo(told[-1][1], nl=False)
    if junit is not None:
        context = Context()
        write_junit(suites, junit, context)
        report(context, form)
        wrong |= context.sink.has_errors
    elif not wrong and used is not None:
        from composer.build.receipt import note

        note(used, arguments(), os.environ, answers, set_files, told)
    sys.exit(FINDINGS if wrong else 0)


def _counted(outcomes: list[Outcome]) -> str:
    if not outcomes:
        return ""
    return f", {len(outcomes)} check{'s hold' if len(outcomes) > 1 else ' holds'}"
