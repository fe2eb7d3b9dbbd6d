"""`mjcompose build`: the model of a recipe, written where the user wants it."""

from __future__ import annotations

import re
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.choices import choice_options, chosen_values
from composer.cli.fetching import fetching, fetching_options
from composer.cli.reporting import FINDINGS, USAGE, progress, report, reporting_options

if TYPE_CHECKING:
    from composer.bundle.write import Form
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session
    from composer.pipeline import Built


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", "out", metavar="OUT",
    help="DIR/, FILE.zip, FILE.mjz, FILE.xml (text alone, '-' for standard output), FILE.mjb or FILE.usdz (also .usd,"
    " .usda, .usdc), in which {name} is the name of the model; default: build/{name}.zip. The name of an MJB gets the"
    " version of MuJoCo, at {mujoco} or before the suffix.",
)  # fmt: skip
@choice_options
@click.option(
    "--all",
    "every",
    is_flag=True,
    help="Build every cell of the recipe's matrix and every sample, or the one model that it is.",
)
@click.option(
    "--pick", "picks", multiple=True, metavar="CELL", help="Build this cell of the matrix, or this sample."
)
@click.option(
    "--samples",
    metavar="FILE",
    help="The table of what was drawn, *.csv or *.parquet; with --all: samples.csv beside the models.",
)
@click.option("--no-verify", is_flag=True, help="Do not compile the result in MuJoCo.")
@click.option("--dedup", is_flag=True, help="Keep identical meshes, textures, materials and height fields of"
              " several parts once; the manifest says which name stands for which.")  # fmt: skip
@click.option("--licenses", is_flag=True, help="Print the licence of every part.")
@click.option("--timeout", type=click.FloatRange(min=0, min_open=True), default=300, show_default=True,
              help="Seconds that MuJoCo may take.")  # fmt: skip
@fetching_options
@reporting_options
def command(
    recipe: Path,
    out: str | None,
    sets: tuple[str, ...],
    set_files: tuple[Path, ...],
    variants: tuple[str, ...],
    every: bool,
    picks: tuple[str, ...],
    samples: str | None,
    no_verify: bool,
    dedup: bool,
    licenses: bool,
    timeout: float,
    form: str,
    as_json: bool,
) -> None:
    """Build the model of RECIPE: one MJCF file and its assets, compiled in MuJoCo before it is written."""
    from composer.bundle.output_error import OutputError
    from composer.context import Context
    from composer.engine import Limits, Session

    form = "json" if as_json else form
    context = Context(fetching=fetching())
    given = chosen_values(sets, set_files, variants, context)
    try:
        kind = kind_of_output(out, many=every or len(picks) > 1)
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
    if context.sink.has_errors:
        report(context, form)
        sys.exit(USAGE)
    wanted = Wanted("build/{name}.zip" if out is None else out, kind, not no_verify, dedup, form, licenses)
    with Session(Limits(seconds=timeout)) as session:
        if every or picks:
            from composer.cli.build_cells import build_cells

            sys.exit(build_cells(recipe, wanted, given, picks, context, session, samples))
        progress(f"building {recipe}")
        sys.exit(build_one(recipe, wanted, given, context, session))


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is built of a recipe, where it goes, and how it is told."""

    out: str
    kind: Form
    verified: bool
    deduplicated: bool
    form: str
    licenses: bool = False


def kind_of_output(out: str | None, many: bool) -> Form:
    """What OUT asks for; raises OutputError where that cannot be told, or `many` models would go to one place."""
    from composer.bundle.output_error import OutputError
    from composer.bundle.write import Form, form_of

    if out is None:
        return Form.ARCHIVE
    if many and "{name}" not in out:
        folder = out if out.endswith("/") else f"{out}/"
        help = f"write for instance `-o '{folder}{{name}}/'` or `-o '{folder}{{name}}.zip'`"
        raise OutputError("output-kind", f"several models cannot all be `{out}`", help)
    return Form.TEXT if out == "-" else form_of(out)


def build_one(
    recipe: Path, wanted: Wanted, given: dict[str, Node], context: Context, session: Session
) -> int:
    from composer.pipeline import build

    built = build(
        recipe,
        context,
        given=given,
        verified=wanted.verified,
        deduplicated=wanted.deduplicated,
        session=session,
    )
    target = None if built is None else put(built, wanted, context, session)
    report(context, wanted.form, err=wanted.out == "-")
    if built is None or target is None or context.sink.has_errors:
        return FINDINGS
    if wanted.out != "-":
        say(built, target, wanted, context)
    elif built.merged:
        click.echo(_merging(built), err=True)
    return 0


def put(built: Built, wanted: Wanted, context: Context, session: Session) -> str | None:
    """Write a model where it is wanted; gives the place, or None where that cannot be, which is told."""
    from composer.bundle.licence_table import licence_rows, tell_unlicensed
    from composer.bundle.mjb import with_version
    from composer.bundle.output_error import OutputError
    from composer.bundle.write import Form

    target = wanted.out.replace("{name}", _file_name(built.plan.name))
    if wanted.kind is Form.MJB:
        target = with_version(target, built.compiled.mujoco_version if built.compiled else None)
    try:
        _write(built, target, wanted.kind, context, session)
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
        return None
    tell_unlicensed(licence_rows(built.plan, context), context)
    return target


def _file_name(name: str) -> str:
    """A model's name as that of a file, which stays in its folder."""
    return re.sub(r"[^\w.+-]+", "_", name).lstrip(".") or "model"


def _write(built: Built, out: str, kind: Form, context: Context, session: Session) -> None:
    from composer.bundle.output_error import OutputError
    from composer.bundle.overwriting import check_is_no_source
    from composer.bundle.text_alone import write_text_alone
    from composer.bundle.write import Form, write

    if built.composed.tabled and kind in (Form.TEXT, Form.MJB):
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        raise OutputError("output-kind", f"`{out}` has no room for the table of draws", help)
    if out != "-":
        check_is_no_source(context.folder / out, built.plan, built.composed.model, built.composed.files)
    if kind is Form.TEXT:
        text = write_text_alone(built.composed.model, built.composed.files, out, context.folder)
        if text is not None and sys.stdout is not None:
            sys.stdout.buffer.write(text)
            sys.stdout.buffer.flush()
        return

    def lost(warning: str) -> None:
        context.sink.warning("usd-loss", f"`{out}` is not the whole model: {warning}")

    write(built.bundle, out, environment=context.environment, session=session, tell=lost)


def say(built: Built, out: str, wanted: Wanted, context: Context) -> None:
    """Tell what was written."""
    import json

    from composer.bundle.licence_table import licence_rows, licence_table

    rows = licence_rows(built.plan, context) if wanted.licenses else []
    sizes = built.compiled.sizes if built.compiled else {}
    if wanted.form == "json":
        told: dict[str, object] = {
            "output": out,
            "name": built.plan.name,
            "sha256": built.bundle.sha256,
            "sizes": dict(sizes),
        }
        if built.merged:
            told["merged"] = {kind: dict(names) for kind, names in built.merged.items()}
        if wanted.licenses:
            told["licences"] = [asdict(row) for row in rows]
        click.echo(json.dumps(told))
        return
    click.echo(f"wrote {out}")
    if sizes:
        counted = ", ".join(_count(*each) for each in (
            (sizes["nbody"], "body", "bodies"), (sizes["nsensor"], "sensor"), (sizes["nkey"], "keyframe")
        ))  # fmt: skip
        click.echo(f"  {built.plan.name}: nq {sizes['nq']}, nv {sizes['nv']}, nu {sizes['nu']}, {counted}")
    else:
        click.echo("  not verified: MuJoCo has not compiled it")
    if built.merged:
        click.echo(_merging(built))
    click.echo(f"  contents sha256 {built.bundle.sha256}")
    if rows:
        click.echo(licence_table(rows))


def _merging(built: Built) -> str:
    plural = {"mesh": "meshes", "hfield": "hfields", "texture": "textures", "material": "materials"}
    counts = ", ".join(
        f"{len(names)} {kind if len(names) == 1 else plural[kind]}" for kind, names in built.merged.items()
    )
    return f"  merged {counts} into equal ones: the manifest and --json say which name stands for which"


def _count(number: int, noun: str, plural: str | None = None) -> str:
    return f"{number} {noun if number == 1 else plural or noun + 's'}"
