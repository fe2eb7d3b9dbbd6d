"""`mjcompose schema`: the JSON Schema of recipes, and the reference page made from it."""

from __future__ import annotations

import click


@click.command()
@click.argument("what", type=click.Choice(["recipe", "manifest", "reference"]), default="recipe")
def command(what: str) -> None:
    """Print the JSON Schema of recipes or manifests for editors and other tools, or the reference page of all keys."""
    if what == "manifest":
        from mjcompose.build.bundle.manifest import schema as manifest_schema

        click.echo(manifest_schema(), nl=False)
        return
    if what == "reference":
        from mjcompose.language.reference_page import page

        click.echo(page(), nl=False)
        return
    from mjcompose.build.plan.extensions import load_all
    from mjcompose.language.schema import text

    for error in load_all():
        click.echo(error.message, err=True)

    click.echo(text(), nl=False)
