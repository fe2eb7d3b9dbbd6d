"""`mjcompose schema`: the JSON Schema of recipes."""

from __future__ import annotations

import click


@click.command()
@click.argument("what", type=click.Choice(["recipe", "manifest"]), default="recipe")
def command(what: str) -> None:
    """Print the JSON Schema of recipes (or of manifests), for editors and other tools."""
    if what == "manifest":
        from composer.bundle.manifest import schema as manifest_schema

        click.echo(manifest_schema(), nl=False)
        return
    from composer.recipe.schema import text

    click.echo(text(), nl=False)
