"""`mjcompose import`: recover the recipe of a merged model from its parts."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

import click

from mjcompose.base.files import foreign_format
from mjcompose.cli.options import output_option, timeout_option
from mjcompose.cli.reporting import FINDINGS, exit_code, progress, report, reporting_options, say

if TYPE_CHECKING:
    from mjcompose.sources.context import Context

_SHOWN = 20


@click.command("import")
@click.argument("merged", type=click.Path(path_type=Path))
@click.argument("parts", type=click.Path(path_type=Path), nargs=-1)
@click.option("--among", "folders", multiple=True, metavar="FOLDER",
              type=click.Path(path_type=Path, exists=True, file_okay=False),
              help="If no PARTS are given, also search for them in this folder.")  # fmt: skip
@output_option("Where the recipe goes; default: MERGED with .yaml, here.")
@timeout_option
@reporting_options
def command(
    merged: Path, parts: tuple[Path, ...], folders: tuple[Path, ...], out: str | None, form: str
) -> None:
    """Propose a recipe that builds the model MERGED from the models PARTS, build it, and report the differences.

    Without PARTS, they are searched for in the folders of --among, in the Menagerie models on this machine, and in
    installed packages. If none are found, the recipe starts from MERGED itself.

    From a URDF or a xacro template, write a recipe that starts from it, and print what of it is read and what is not.

    Parts are recognized by the names of their bodies, with or without a prefix. What a recipe cannot express is written
    as a comment. Exit codes: 0 the recipe builds the same model, 1 something differs or cannot be read or built, 2
    wrong usage.
    """
    from mjcompose.cli.fmt import rewrite
    from mjcompose.sources.context import Context
    from mjcompose.tools.importing.recover import amount, changed, recover
    from mjcompose.tools.importing.recover import left as differs

    context = Context()
    target = Path(out) if out is not None else Path(f"{merged.stem}.yaml")
    if os.path.lexists(target):
        raise click.UsageError(f"{target} exists already and is left as it is: choose another name with -o")
    if parts and folders:
        raise click.UsageError("PARTS are named, so that nothing is looked for: leave --among out")
    if named := next((each for each in parts if _is_reference(each)), None):
        raise click.UsageError(
            f"PARTS are files, and `{named}` is a reference. "
            "Leave PARTS out: Menagerie and installed packages are searched"
        )
    _refuse_foreign((merged, *parts), context, form)
    progress(f"reading {merged}")
    if merged.suffix.lower() in (".urdf", ".xacro"):
        _urdf(merged, bool(parts or folders), target, context=context, form=form)
    references: dict[Path, str] = {}
    if not parts:
        parts, references = _searched(merged, folders, target, context=context, form=form)
    found = (
        recover(merged, list(parts), target, context=context, progress=progress, references=references)
        if parts
        else None
    )
    if found is not None:
        rewrite(target, found.text.encode(), context)
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
        answer = {
            "output": str(target),
            "parts": len(found.proposal.found),
            "comments": len(left),
            "changed": edits,
            "differences": different,
        }
        click.echo(json.dumps(answer))
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
        say(f"it builds, and the model is that of {shown}, element by element, to seven digits{but}")
    else:
        several(f"it builds, and is not yet the model of {shown}", different)
    sys.exit(FINDINGS if outcome is None or not outcome.same else 0)


def _refuse_foreign(files: tuple[Path, ...], context: Context, form: str) -> None:
    """End with an error for each file in a format that is not read."""
    for file in files:
        if (found := foreign_format(file)) is not None:
            shown = context.shown(file)
            context.sink.error("source-kind", found.message(shown), help=found.help(shown))
    if context.sink.has_errors:
        report(context, form)
        sys.exit(exit_code(context.folder, files))


def _urdf(file: Path, is_more_named: bool, target: Path, context: Context, form: str) -> NoReturn:
    """The recipe that starts from a URDF, and the table of what is read."""
    from mjcompose.cli.fmt import rewrite
    from mjcompose.tools.importing.propose import of_urdf, table

    if is_more_named:
        raise click.UsageError("a URDF is taken whole: leave PARTS and --among out")
    found = of_urdf(file, target, context)
    if found is not None:
        rewrite(target, found.text.encode(), context)
    report(context, form)
    if found is None or context.sink.has_errors:
        sys.exit(exit_code(context.folder, [file]))
    if form == "json":
        rows = [
            {
                "what": row.what,
                "count": row.count,
                "became": row.became or None,
                "why": row.why or None,
                "first": str(row.span),
            }
            for row in found.rows
        ]
        click.echo(json.dumps({"output": str(target), "rows": rows}))
    else:
        say(f"wrote {target}: it starts from {context.shown(file)}")
        for line in table(found.rows):
            say(line)
    sys.exit(0)


def _is_reference(part: Path) -> bool:
    """Return whether a file argument is a reference such as `menagerie:…`; a single letter is a drive."""
    return re.match(r"[a-z][a-z+]+:", str(part)) is not None and not os.path.exists(part)


def _searched(
    merged: Path, folders: tuple[Path, ...], target: Path, context: Context, form: str
) -> tuple[tuple[Path, ...], dict[Path, str]]:
    """Return the parts that were found, with their references if they have one; exit if there are none."""
    from mjcompose.cli.fmt import rewrite
    from mjcompose.tools.importing.recover import amount, whole_recipe
    from mjcompose.tools.importing.search import search

    result = search(merged, folders, context, progress=progress)
    if result is None:
        report(context, form)
        sys.exit(exit_code(context.folder, [merged]))
    looked = f"among {amount(result.looked_at, 'model')}"
    if result.parts:
        names = [each.reference or context.shown(each.path) for each in result.parts]
        say(f"found {amount(len(names), 'part')} {looked}: {', '.join(names)}", err=form == "json")
        references = {each.path: each.reference for each in result.parts if each.reference is not None}
        return tuple(each.path for each in result.parts), references
    if not rewrite(target, whole_recipe(merged, target).encode(), context):
        report(context, form)
        sys.exit(FINDINGS)
    if form == "json":
        answer = {"output": str(target), "parts": 0, "comments": 0, "changed": [], "differences": []}
        click.echo(json.dumps(answer))
    say(f"found none of its parts {looked}; --among FOLDER looks further", err=form == "json")
    say(f"wrote {target}: it starts from {context.shown(merged)} as it is", err=form == "json")
    sys.exit(0)


def several(heading: str, lines: list[str]) -> None:
    """Print lines below a heading, only the first of many."""
    if not lines:
        return
    say(f"{heading}:")
    for line in lines[:_SHOWN]:
        say(f"  {line}")
    if len(lines) > _SHOWN:
        say(f"  … and {len(lines) - _SHOWN} more")
