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
    Exit codes: 0 the recipe builds the same model, 1 something differs or cannot be read or built, 2 wrong usage.
    """
    from composer.bundle.output_error import OutputError
    from composer.bundle.staging import staged_file
    from composer.context import Context
    from composer.importing.recover import recover
    from composer.importing.words import amount, changed
    from composer.importing.words import left as differs

    context = Context()
    target = Path(out) if out is not None else Path(f"{merged.stem}.yaml")
    if os.path.lexists(target):
        raise click.UsageError(f"{target} is there already and is left as it is: choose another name with -o")
    progress(f"reading {merged}")
    found = recover(merged, list(parts), target, context, progress)
    if found is not None:
        try:
            with staged_file(target) as stage:
                stage.write_text(found.text, encoding="utf-8")
        except OutputError as error:
            context.sink.add(error.diagnostic)
        for fault in found.faults:
            context.sink.add(fault)
    report(context, form)
    if found is None or context.sink.has_errors:
        sys.exit(exit_code(context.folder, [merged, *parts]))
    shown = context.shown(merged)
    left = [entry for entry in found.proposal.entries if entry.note is not None]
    outcome = found.outcome
    edits = list(changed(found.proposal.changed))
    different = None if outcome is None else [] if outcome.same else list(differs(outcome, shown))
    if form == "json":
        told = {
            "output": str(target),
            "parts": len(found.proposal.found),
            "comments": len(left),
            "changed": edits,
            "differences": different,
        }
        click.echo(json.dumps(told))
        sys.exit(FINDINGS if outcome is None or not outcome.same else 0)
    only = (
        f", {amount(len(left), 'entry', 'entries')} only as {'a comment' if len(left) == 1 else 'comments'}"
    )
    say(f"wrote {target}: {amount(len(found.proposal.found), 'part')}{only if left else ''}")
    several(f"changed in {shown}, and written into the recipe", edits)
    if outcome is None or different is None:
        why = f": MuJoCo rejects {shown}: {found.refused}" if found.refused else ""
        click.echo(f"the two models could not be compared{why}")
    elif outcome.same:
        rounded = amount(len(outcome.rounded), "number")
        verb = "is" if len(outcome.rounded) == 1 else "are"
        but = f"; {rounded} {verb} equal to six digits only" if outcome.rounded else ""
        say(f"it builds, and the model is that of {shown}, element by element{but}")
    else:
        several(f"it builds, and is not yet the model of {shown}", different)
    sys.exit(FINDINGS if outcome is None or not outcome.same else 0)


def several(heading: str, lines: list[str]) -> None:
    """Lines below a heading, of many only the first."""
    if not lines:
        return
    say(f"{heading}:")
    for line in lines[:_SHOWN]:
        say(f"  {line}")
    if len(lines) > _SHOWN:
        say(f"  … and {len(lines) - _SHOWN} more")
