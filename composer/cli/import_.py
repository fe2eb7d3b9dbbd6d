"""`mjcompose import`: from a merged model and its parts to the recipe."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import click

from composer.cli.output import output_option
from composer.cli.reporting import FINDINGS, exit_code, progress, report, reporting_options, say

_SHOWN = 20


@click.command("import")
@click.argument("merged", type=click.Path(path_type=Path))
@click.argument("parts", type=click.Path(path_type=Path), nargs=-1, required=True)
@output_option("Where the recipe goes; default: MERGED with .yaml, here.")
@reporting_options
def command(merged: Path, parts: tuple[Path, ...], out: str | None, form: str) -> None:
    """Propose the recipe that makes the model MERGED of the models PARTS; build it, and say what still differs.

    Parts are found by the names of their bodies, with a prefix or without. What a recipe cannot say is a comment.
    """
    from composer.bundle.output_error import OutputError
    from composer.bundle.staging import staged_file
    from composer.context import Context
    from composer.importing.recover import recover

    context = Context()
    target = Path(out) if out is not None else Path(f"{merged.stem}.yaml")
    if os.path.lexists(target):
        raise click.UsageError(f"{target} is there already and is left as it is: choose another name with -o")
    progress(f"reading {merged}")
    found = recover(merged, list(parts), target, context)
    if found is not None:
        try:
            with staged_file(target) as stage:
                stage.write_text(found.text, encoding="utf-8")
        except OutputError as error:
            context.sink.error(error.code, error.message, help=error.help)
        for fault in found.faults:
            context.sink.add(fault)
    report(context, form)
    if found is None or context.sink.has_errors:
        sys.exit(exit_code(context.folder, [merged, *parts]))
    left = [entry for entry in found.proposal.entries if entry.note is not None]
    differences = found.differences
    if form == "json":
        told = {
            "output": str(target),
            "parts": len(found.proposal.found),
            "comments": len(left),
            "differences": None if differences is None else list(map(str, differences)),
        }
        click.echo(json.dumps(told))
        sys.exit(FINDINGS if differences is None or differences else 0)
    say(f"wrote {target}: {len(found.proposal.found)} parts, {len(left)} entries only as comments")
    if differences is None:
        click.echo("the two models could not be compared")
    elif not differences:
        say(f"it builds, and the model is that of {merged}, element by element")
    else:
        click.echo(f"it builds; {len(differences)} values differ from {merged}:")
        for each in differences[:_SHOWN]:
            click.echo(f"  {each}")
        if len(differences) > _SHOWN:
            click.echo(f"  … and {len(differences) - _SHOWN} more")
    sys.exit(FINDINGS if differences is None or differences else 0)
