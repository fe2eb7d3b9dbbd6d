"""`mjcompose build`: the model of a recipe, written where the user wants it."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.reporting import FINDINGS, USAGE, progress, report, reporting_options

if TYPE_CHECKING:
    from composer.bundle.write import Form
    from composer.context import Context
    from composer.engine import Limits
    from composer.pipeline import Built


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", "out", metavar="OUT",
    help="DIR/, FILE.zip, FILE.mjz, FILE.xml (text alone, '-' for standard output) or FILE.mjb;"
    " default: build/NAME.zip.",
)  # fmt: skip
@click.option("--no-verify", is_flag=True, help="Do not compile the result in MuJoCo.")
@click.option("--dedup", is_flag=True, help="Keep identical meshes, textures, materials and height fields of"
              " several parts once; the manifest says which name stands for which.")  # fmt: skip
@click.option("--timeout", type=click.FloatRange(min=0, min_open=True), default=300, show_default=True,
              help="Seconds that MuJoCo may take.")  # fmt: skip
@reporting_options
def command(
    recipe: Path, out: str | None, no_verify: bool, dedup: bool, timeout: float, form: str, as_json: bool
) -> None:
    """Build the model of RECIPE: one MJCF file and its assets, compiled in MuJoCo before it is written."""
    from composer.bundle.output_error import OutputError
    from composer.bundle.write import Form, form_of
    from composer.context import Context
    from composer.engine import Limits
    from composer.pipeline import build

    form = "json" if as_json else form
    context = Context()
    try:
        kind = Form.TEXT if out in (None, "-") else form_of(str(out))
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
        report(context, form)
        sys.exit(USAGE)
    progress(f"building {recipe}")
    built = build(recipe, context, verified=not no_verify, deduplicated=dedup, limits=Limits(seconds=timeout))
    if built is None:
        report(context, form)
        sys.exit(FINDINGS)
    target = out if out is not None else f"build/{_file_name(built.plan.name)}.zip"
    try:
        _write(built, target, kind if out else Form.ARCHIVE, context, Limits(seconds=timeout))
    except OutputError as error:
        context.sink.error(error.code, error.message, help=error.help)
    report(context, form, err=out == "-")
    if context.sink.has_errors:
        sys.exit(FINDINGS)
    if out != "-":
        _say(built, target, form)
    elif built.merged:
        click.echo(_merging(built), err=True)


def _file_name(name: str) -> str:
    """A model's name as that of a file, which stays in its folder."""
    return re.sub(r"[^\w.+-]+", "_", name).lstrip(".") or "model"


def _write(built: Built, out: str, kind: Form, context: Context, limits: Limits) -> None:
    from composer.bundle.overwriting import check_is_no_source
    from composer.bundle.text_alone import write_text_alone
    from composer.bundle.write import Form, write

    if out != "-":
        check_is_no_source(context.folder / out, built.plan, built.composed.model, built.composed.files)
    if kind is Form.TEXT:
        text = write_text_alone(built.composed.model, built.composed.files, out, context.folder)
        if text is not None and sys.stdout is not None:
            sys.stdout.buffer.write(text)
            sys.stdout.buffer.flush()
        return
    write(built.bundle, out, environment=context.environment, limits=limits)


def _say(built: Built, out: str, form: str) -> None:
    import json

    sizes = built.compiled.sizes if built.compiled else {}
    if form == "json":
        told: dict[str, object] = {
            "output": out,
            "name": built.plan.name,
            "sha256": built.bundle.sha256,
            "sizes": dict(sizes),
        }
        if built.merged:
            told["merged"] = {kind: dict(names) for kind, names in built.merged.items()}
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


def _merging(built: Built) -> str:
    plural = {"mesh": "meshes", "hfield": "hfields", "texture": "textures", "material": "materials"}
    counts = ", ".join(
        f"{len(names)} {kind if len(names) == 1 else plural[kind]}" for kind, names in built.merged.items()
    )
    return f"  merged {counts} into equal ones: the manifest and --json say which name stands for which"


def _count(number: int, noun: str, plural: str | None = None) -> str:
    return f"{number} {noun if number == 1 else plural or noun + 's'}"
