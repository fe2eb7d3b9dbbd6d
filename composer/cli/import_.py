"""`mjcompose import`: from a merged model and its parts to the recipe."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import click

from composer.cli.reporting import FINDINGS, progress, report

_SHOWN = 20


@click.command("import")
@click.argument("merged", type=click.Path(path_type=Path))
@click.argument("parts", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option(
    "-o",
    "--output",
    "out",
    type=click.Path(path_type=Path),
    help="Where the recipe goes; default: MERGED with .yaml, here.",
)
def command(merged: Path, parts: tuple[Path, ...], out: Path | None) -> None:
    """Propose the recipe that makes the model MERGED of the models PARTS; build it, and say what still differs.

    Parts are found by the names of their bodies, with a prefix or without. What a recipe cannot say is a comment.
    Exit codes: 0 the recipe builds the same model, 1 something differs or cannot be read or built, 2 wrong usage.
    """
    from composer.bundle.output_error import OutputError
    from composer.bundle.staging import staged_file
    from composer.context import Context
    from composer.importing.recover import recover
    from composer.importing.words import amount, changed
    from composer.importing.words import left as differs

    context = Context()
    target = out or Path(f"{merged.stem}.yaml")
    if os.path.lexists(target):
        raise click.UsageError(f"{target} is there already and is left as it is: choose another name with -o")
    progress(f"reading {merged}")
    found = recover(merged, list(parts), target, context, progress)
    if found is not None:
        try:
            with staged_file(target) as stage:
                stage.write_text(found.text, encoding="utf-8")
        except OutputError as error:
            context.sink.error(error.code, error.message, help=error.help)
        for fault in found.faults:
            context.sink.add(fault)
    report(context, "text")
    if found is None or context.sink.has_errors:
        sys.exit(FINDINGS)
    shown = context.shown(merged)
    left = [entry for entry in found.proposal.entries if entry.note is not None]
    only = (
        f", {amount(len(left), 'entry', 'entries')} only as {'a comment' if len(left) == 1 else 'comments'}"
    )
    click.echo(f"wrote {target}: {amount(len(found.proposal.found), 'part')}{only if left else ''}")
    several(
        f"changed in {shown}, and written into the recipe",
        list(changed(found.proposal.changed)),
    )
    outcome = found.outcome
    if outcome is None:
        why = f": MuJoCo rejects {shown}: {found.refused}" if found.refused else ""
        click.echo(f"the two models could not be compared{why}")
    elif outcome.same:
        rounded = amount(len(outcome.rounded), "number")
        verb = "is" if len(outcome.rounded) == 1 else "are"
        but = f"; {rounded} {verb} equal to six digits only" if outcome.rounded else ""
        click.echo(f"it builds, and the model is that of {shown}, element by element{but}")
    else:
        several(f"it builds, and is not yet the model of {shown}", list(differs(outcome, shown)))
    sys.exit(FINDINGS if outcome is None or not outcome.same else 0)


def several(heading: str, lines: list[str]) -> None:
    """Lines below a heading, of many only the first."""
    if not lines:
        return
    click.echo(f"{heading}:")
    for line in lines[:_SHOWN]:
        click.echo(f"  {line}")
    if len(lines) > _SHOWN:
        click.echo(f"  … and {len(lines) - _SHOWN} more")
