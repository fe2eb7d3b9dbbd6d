"""`mjcompose build`: the model of a recipe, written where the user wants it."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from composer.cli.built_words import remarks, said
from composer.cli.caching import caching, caching_options
from composer.cli.choices import choice_options, chosen_values, named_choices
from composer.cli.fetching import fetching, fetching_options
from composer.cli.matrix import cells_options
from composer.cli.output import output_option
from composer.cli.reporting import (
    USAGE,
    arguments,
    clear_progress,
    exit_code,
    is_quiet,
    progress,
    report,
    reporting_options,
    say,
    told_by_report,
)  # fmt: skip
from composer.cli.timeout import timeout_option
from composer.cli.wanted import Wanted, for_shared_assets, kind_of_output

if TYPE_CHECKING:
    from composer.bundle.bundle import Bundle
    from composer.cache.builder import Maker
    from composer.cache.result import Made
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session


@click.command()
@click.argument("recipe", type=click.Path(path_type=Path))
@output_option(
    "DIR/, FILE.zip, FILE.mjz, FILE.xml (text alone, '-' for standard output), FILE.mjb or FILE.usdz (also .usd, .usda,"
    " .usdc). {name} is the name of the model, and {mujoco} in that of an MJB the version of MuJoCo, the only one that"
    " reads it. Default: build/{name}.zip."
)
@choice_options
@cells_options
@click.option(
    "--samples",
    metavar="FILE",
    help="The table of what was drawn, *.csv or *.parquet; with --all: samples.csv beside the models.",
)
@click.option("--shared-assets", is_flag=True, help="Keep the assets of all cells in one folder: with"
              " -o 'DIR/{name}/' that is DIR/assets/.")  # fmt: skip
@click.option("--no-verify", is_flag=True, help="Do not compile the result in MuJoCo.")
@click.option("--dedup", is_flag=True, help="Keep identical meshes, textures, materials and height fields of"
              " several parts once; the manifest says which name stands for which.")  # fmt: skip
@click.option("--licenses", is_flag=True, help="Print the licence of every part.")
@timeout_option
@caching_options
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
    only_samples: tuple[int, ...],
    samples: str | None,
    shared_assets: bool,
    no_verify: bool,
    dedup: bool,
    licenses: bool,
    timeout: float,
    no_cache: bool,
    why: bool,
    form: str,
) -> None:
    """Build the model of RECIPE: one MJCF file and its assets, compiled in MuJoCo before it is written."""
    from composer.bundle.output_error import OutputError
    from composer.cache.builder import Maker
    from composer.cache.options import Order
    from composer.context import Context

    how = fetching()
    context = Context(fetching=how)
    one = not every and not picks and not only_samples
    try:
        if shared_assets:
            out, kind = for_shared_assets(out, one=one)
        else:
            kind = kind_of_output(out)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        report(context, form)
        sys.exit(USAGE)
    wanted = Wanted(
        "build/{name}.zip" if out is None else out, kind, not no_verify, dedup, form, why, licenses
    )
    order = Order(
        wanted.verified, dedup, wanted.text_beside(context.folder), named_choices(sets, set_files, variants, context),
        how.locked, how.offline,
    )  # fmt: skip
    with caching(context, no_cache) as cache:
        maker = Maker(recipe, order, cache, context, kind, partial(wanted.place, context.folder))
        reasons: tuple[str, ...] = ()
        if one:
            known, reasons = maker.recall(maker.question(), context)
            if known is not None:
                sys.exit(finish(known, maker, wanted, context, None, set_files))
        given = chosen_values(sets, set_files, variants, context)
        if context.sink.has_errors:
            report(context, form)
            sys.exit(USAGE)
        from composer.engine import Limits, Session

        with Session(Limits(seconds=timeout)) as session:
            if not one:
                from composer.cli.build_cells import build_cells

                sys.exit(build_cells(maker, wanted, given, picks, only_samples, context, session, samples))
            sys.exit(build_one(maker, wanted, given, context, session, reasons, set_files))


def build_one(
    maker: Maker,
    wanted: Wanted,
    given: dict[str, Node],
    context: Context,
    session: Session,
    why: tuple[str, ...],
    set_files: tuple[Path, ...] = (),
) -> int:
    """Build the one model that the recipe is; gives the exit code."""
    progress(f"building {maker.recipe}")
    made = maker.make(context, session, given, question=maker.question(), why=why)
    return finish(made, maker, wanted, context, session, set_files)


def finish(
    made: Made | None,
    maker: Maker,
    wanted: Wanted,
    context: Context,
    session: Session | None,
    set_files: tuple[Path, ...] = (),
) -> int:
    """Write the model, and tell what there is to tell; gives the exit code."""
    made = None if made is None else put(made, maker, wanted, context, session)
    report(context, wanted.form, err=wanted.out == "-")
    if made is None or context.sink.has_errors:
        return exit_code(context.folder, [maker.recipe])
    if wanted.out == "-":
        for line in remarks(made, wanted):
            say(line, err=True)
        return 0
    say(said(made, wanted), form=wanted.form)
    if wanted.kind != "usd":
        _note(made, maker, wanted, context, set_files)
    return 0


def _note(made: Made, maker: Maker, wanted: Wanted, context: Context, set_files: tuple[Path, ...]) -> None:
    """Leave a receipt, so that the same command need not be run again."""
    target = maker.place(made.name, made.mujoco)
    if maker.cache is None or made.answer is None or target is None:
        return
    from composer.cache.receipt import Output, note

    record = maker.cache.record(made.answer) if wanted.kind in ("archive", "text") else None
    reported, known = told_by_report(context, wanted.form), replace(made, built=None, why=(), replaced={})
    silent = is_quiet() and wanted.form != "json"
    same, anew = (
        [
            *reported,
            *([] if silent else [(False, f"{said(replace(known, is_written=is_written), wanted)}\n")]),
        ]
        for is_written in (True, False)
    )
    output = Output(os.fspath(target), maker.content(made), anew, record)
    note(maker.cache, arguments(), context.environment, [made.answer], set_files, same, output)


def put(made: Made, maker: Maker, wanted: Wanted, context: Context, session: Session | None) -> Made | None:
    """Write a model where it is wanted; gives it as it was written, or None where that cannot be, which is told."""
    from composer.bundle.licence_table import tell_unlicensed
    from composer.bundle.output_error import OutputError
    from composer.bundle.replaced import made_of

    clear_progress()
    target = wanted.target(made.name, made.mujoco)
    try:
        if wanted.kind == "text" and made.built is not None:
            from composer.bundle.text_alone import text_alone

            composed = made.built.composed
            text = text_alone(composed.model, composed.files, target, context.folder)
            made = maker.with_text(made, text, context)
        if not made.is_written:
            before = None if wanted.kind in ("text", "usd") else made_of(context.folder / target)
            maker.note_written(made, _write(made, target, maker, wanted, context, session))
            now = None if before is None else made_of(context.folder / target)
            if before is not None and now is not None:
                made = replace(made, replaced=before.other_than(now))
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    tell_unlicensed(made.licences, context)
    return made


def _write(
    made: Made, out: str, maker: Maker, wanted: Wanted, context: Context, session: Session | None
) -> tuple[Path, ...]:
    """Gives what was written elsewhere than to `out`."""
    from composer.bundle.overwriting import check_is_no_source, files_read

    built = made.built
    if wanted.kind in ("text", "mjb", "usd") and made.bundle is not None:
        _check_holds_all(made.bundle, out)
    if out != "-":
        read: Iterator[Path] = map(Path, made.inputs)
        if built is not None:
            read = files_read(built.plan, built.composed.model, built.composed.files)
        check_is_no_source(context.folder / out, read)
    if wanted.kind == "text":
        text = made.text
        assert text is not None
        if out != "-":
            from composer.bundle.staging import staged_file

            with staged_file(context.folder / out) as stage:
                stage.write_bytes(text)
        elif sys.stdout is not None:
            sys.stdout.buffer.write(text)
            sys.stdout.buffer.flush()
    elif wanted.kind == "folder with shared assets":
        from composer.bundle.shared import write_shared

        assert made.bundle is not None
        return write_shared(made.bundle, Path(os.path.abspath(context.folder / out)))
    elif made.packed and made.record is not None:
        from composer.bundle.archive import write_packed

        write_packed(made.packed, made.record.model, Path(out), context.environment, made.packed.__getitem__)
    else:
        from composer.bundle.write import write

        def lost(warning: str) -> None:
            context.sink.warning("usd-loss", f"`{out}` is not the whole model: {warning}")

        assert made.bundle is not None
        write(
            made.bundle, out, environment=context.environment, session=session, packing=maker.packing, tell=lost
        )  # fmt: skip
        if wanted.kind == "mjb":
            from composer.bundle.mjb import manifest_beside

            return (manifest_beside(Path(os.path.abspath(context.folder / out))),)
    return ()


def _check_holds_all(bundle: Bundle, out: str) -> None:
    """Refuse an output that has no room for a table of draws."""
    from composer.bundle.bundle import DRAWS
    from composer.bundle.output_error import OutputError

    if DRAWS in bundle.files:
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        raise OutputError("output-kind", f"`{out}` has no room for the table of draws", help)
