"""`mjcompose check`: everything a build would find, and nothing written."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from composer.cli.choices import choice_options, chosen_values
from composer.cli.fetching import fetching, fetching_options
from composer.cli.reporting import FINDINGS, progress, report, reporting_options


@click.command()
@click.argument("recipes", type=click.Path(path_type=Path), nargs=-1, required=True)
@choice_options
@click.option("--no-verify", is_flag=True, help="Do not compile the models in MuJoCo.")
@fetching_options
@reporting_options
def command(
    recipes: tuple[Path, ...],
    sets: tuple[str, ...],
    set_files: tuple[Path, ...],
    variants: tuple[str, ...],
    no_verify: bool,
    form: str,
    as_json: bool,
) -> None:
    """Say whether each of RECIPES is right: read, planned, composed and compiled in MuJoCo, nothing written."""
    from composer.context import Context
    from composer.pipeline import build

    form = "json" if as_json else form
    wrong = False
    for recipe in recipes:
        context = Context(fetching=fetching())
        given = chosen_values(sets, set_files, variants, context)
        progress(f"checking {recipe}")
        built = build(recipe, context, given=given, verified=not no_verify)
        report(context, form)
        wrong |= built is None
        if built is not None and form == "text":
            click.echo(f"{recipe}: ok")
    sys.exit(FINDINGS if wrong else 0)
