"""`verify`, `list` and `rebuild`: check bundles, list them, and build one again from its stamp."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.naming import file_name
from mjcompose.base.report import MjcomposeError, json_text, one_line, printable
from mjcompose.bundle.bundle import is_address
from mjcompose.bundle.listing import COLUMNS
from mjcompose.bundle.staging import check_own_place
from mjcompose.cli.options import STRICT, FetchOptions, LimitOptions, ReportOptions, TimeOptions
from mjcompose.cli.reporting import FINDINGS, USAGE, progress, say
from mjcompose.cli.run import PATH, Answer, Group, Run, Stop, argument, command, group, option
from mjcompose.text.expression import shown

if TYPE_CHECKING:
    from mjcompose.verify.stored import VerifiedBundle


class VerifyOptions(Group):
    bundles: tuple[Path, ...] = argument(metavar="BUNDLE...", type=PATH, nargs=-1, required=True)
    recipe: Path | None = option(
        "--recipe",
        type=PATH,
        help="The recipe that the bundle was built from, to find the sources of its parts.",
    )
    limits: TimeOptions = group(TimeOptions)
    strict: bool = STRICT
    reporting: ReportOptions = group(ReportOptions)


@command(
    VerifyOptions,
    help="""Verify each BUNDLE: a folder, .zip or .mjz.

    A bundle is valid if its files have the hashes in the manifest, MuJoCo compiles it, its joints, actuators,
    sensors and keyframes have the order of the manifest, and every part is the same as its source alone.
    """,
)
def verify(options: VerifyOptions, run: Run) -> int:
    from mjcompose.mujoco.engine import Session
    from mjcompose.verify.stored import verify_stored

    code = 0
    recipe = options.recipe
    for bundle in options.bundles:
        context = run.new_context()
        progress(f"verifying {bundle}")
        with Session() as session:
            stored = verify_stored(bundle, context, session, recipe=recipe)
        if context.strict:
            context.sink.promote()
        run.report(context)
        if context.sink.has_errors:
            code = max(code, run.code_of_failure(bundle, *([] if recipe is None else [recipe])))
        if stored is not None:
            _say(stored, str(bundle), run.form, ok=not context.sink.has_errors)
    return code


def _say(stored: VerifiedBundle, path: str, form: str, *, ok: bool) -> None:
    if form == "json":
        parts = [
            {"part": each.member.part, "unchanged": None if each.obscure is not None else each.ok}
            for each in stored.parts
        ]
        click.echo(json_text({"bundle": path, "ok": ok, "sha256": stored.bundle.sha256, "parts": parts}))
    elif form == "text" and ok:
        unchanged = sum(each.ok for each in stored.parts)
        compared = f", {unchanged} of {len(stored.parts)} parts compared with their sources and unchanged"
        say(f"{path}: ok: {len(stored.bundle.files)} files{compared if stored.parts else ', no parts'}")


class ListOptions(Group):
    folder: str = argument(type=click.Path())
    where: str | None = option(
        "--where",
        metavar="EXPRESSION",
        help="List only the models for which this is true: an expression of the columns of models.csv, such as"
        " `payload > 2 and nv == 15`.",
    )
    reporting: ReportOptions = group(ReportOptions)


@command(
    ListOptions,
    help="""List the models that `build --all` wrote to FOLDER.

    FOLDER is a folder with the index of the models, or the file of an index; either may be a URL. Each line has the
    path of a model, and its values from the matrix and from draws. JSON has all columns of the index.
    """,
)
def list(options: ListOptions, run: Run) -> int:
    from mjcompose.bundle.listing import ListingError, RowCondition, rows

    context = run.context
    folder = options.folder
    condition = None
    try:
        condition = RowCondition(options.where or "true")
        for row in rows(folder if is_address(folder) else Path(folder), folder):
            if condition.holds(row):
                path = row.file if isinstance(row.file, str) else context.shown(row.file)
                own = (f"{name}={shown(value)}" for name, value in row.values.items() if name not in COLUMNS)
                data = {**row.values, "path": path}
                if run.form == "json":
                    click.echo(json_text(data, ensure_ascii=False))
                else:
                    click.echo(printable(one_line(" ".join((path, *own)))))
        condition.check()
    except ListingError as error:
        context.sink.add(error.diagnostic)
        is_there = is_address(folder) or os.path.exists(folder)
        return USAGE if condition is None or not is_there else FINDINGS
    run.report()
    for name, count in condition.lacking.items():
        say(f"{count} models have no `{name}`, and are not listed", err=True)
    return 0


class RebuildOptions(Group):
    stamp: Path = argument(type=PATH)
    recipe: Path | None = argument(type=PATH, required=False)
    out: str | None = option(
        "-o", "--output", metavar="PATH", help="Where to write the model, as with `build`. Default: build/NAME.zip."
    )
    fetching: FetchOptions = group(FetchOptions)
    limits: LimitOptions = group(LimitOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    RebuildOptions,
    help="""Build the model of STAMP again, to the byte, or say what differs and write nothing.

    STAMP is a JSON file with the result of `mjcompose.stamp(BUNDLE)`. RECIPE is its recipe, by default at the path that
    the stamp records, from the folder of the stamp.
    """,
)
def rebuild(options: RebuildOptions, run: Run) -> Answer:
    from mjcompose.bundle.write import write
    from mjcompose.tools.open.stamp import read_stamp, rebuild as build_again

    context = run.context
    try:
        record = read_stamp(context.folder / options.stamp, str(options.stamp))
    except MjcomposeError as error:
        context.sink.extend(error.diagnostics)
        raise Stop(USAGE) from None
    recipe = Path(os.path.normpath(options.stamp.parent / record.recipe)) if options.recipe is None else options.recipe
    bundle = build_again(record, context.folder / recipe, context)
    if bundle is None:
        raise Stop(FINDINGS)
    out = options.out or f"build/{file_name(record.name)}.zip"
    with run.stopping(FINDINGS):
        if options.out is None:
            check_own_place(context.folder / out)
        write(bundle, context.folder / out, environment=context.environment)
    return Answer(f"wrote {out}: the bytes of the stamp", {"wrote": out, "sha256": bundle.sha256}, is_outcome=True)
