"""`mjcompose plan`: what a build will do, in words or as JSON."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from composer.cli.reporting import FINDINGS, report, reporting_options


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@reporting_options
def command(recipe: Path, form: str, as_json: bool) -> None:
    """Print what a build of RECIPE will do, step by step."""
    from composer.context import Context
    from composer.plan.describe import Subtrees, as_data, describe
    from composer.plan.make import make_plan

    form = "json" if as_json else form
    context = Context()
    plan = make_plan(recipe, context)
    subtrees: Subtrees = {}
    if plan is not None and plan.takes_subtrees:
        from composer.steps.left_behind import left_behind

        subtrees = left_behind(plan, context)
    report(context, form)
    if plan is None:
        sys.exit(FINDINGS)
    click.echo(json.dumps(as_data(plan, subtrees), indent=2) if form == "json" else describe(plan, subtrees))
    if context.sink.has_errors:
        sys.exit(FINDINGS)
