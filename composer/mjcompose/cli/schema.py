"""`mjcompose schema`: the JSON Schema of recipes, and the reference page made from it."""

from __future__ import annotations

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.run import Answer, Run, argument, command


@dataclass(frozen=True, slots=True)
class Options:
    what: str = argument(type=click.Choice(["recipe", "manifest", "diagnostics", "reference"]), default="recipe")


@command(Options)
def schema(options: Options, run: Run) -> Answer:
    """Print a JSON Schema for editors and other tools, or the reference page of all keys.

    The schema is that of recipes, of the manifests in bundles, or of the lines of --output-format json.
    """
    if options.what == "manifest":
        from mjcompose.build.bundle.manifest import schema as text
    elif options.what == "diagnostics":
        from mjcompose.base.report_schema import text
    elif options.what == "reference":
        from mjcompose.language.reference_page import page as text
    else:
        from mjcompose.build.plan.extensions import load_all
        from mjcompose.language.schema import text

        for error in load_all():
            click.echo(error.message, err=True)
    return Answer(text().removesuffix("\n"))
