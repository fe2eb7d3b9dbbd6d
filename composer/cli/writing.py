"""Write a model that `mjcompose build` made, and report it."""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.place import is_address, place
from composer.cli.built_words import remarks, said
from composer.cli.noted import note_files
from composer.cli.picturing import picture_beside
from composer.cli.reporting import clear_progress, exit_code, progress, report, say, say_details
from composer.cli.wanted import Wanted
from composer.diagnostics.diagnostic import Severity

if TYPE_CHECKING:
    from composer.bundle.bundle import Bundle
    from composer.cache.builder import Maker
    from composer.cache.result import Made
    from composer.context import Context
    from composer.document import Node
    from composer.engine import Session


def build_one(
    maker: Maker,
    wanted: Wanted,
    given: dict[str, Node],
    context: Context,
    session: Session,
    why: tuple[str, ...],
) -> int:
    """Build the single model of the recipe. Return the exit code."""
    progress(f"building {maker.recipe}")
    made = maker.make(context, session, given, key=maker.key(), why=why)
    return finish(made, maker, wanted, context=context, session=session)


def finish(
    made: Made | None,
    maker: Maker,
    wanted: Wanted,
    context: Context,
    session: Session | None,
) -> int:
    """Write the model and report it. Return the exit code."""
    from composer.cache.result import files_of

    files = files_of(made, context)
    note_files(files)
    made = None if made is None else put(made, maker, context, session=session, wanted=wanted)
    if made is not None:
        add_picture(made, wanted, context)
    report(context, wanted.form, err=wanted.out == "-")
    say_details(context, files)
    if made is None or context.sink.has_errors:
        return exit_code(context.folder, [maker.recipe])
    if wanted.out == "-":
        for line in remarks(made, wanted):
            say(line, err=True)
        return 0
    say(said(made, wanted), form=wanted.form)
    return 0


def put(made: Made, maker: Maker, context: Context, session: Session | None, wanted: Wanted) -> Made | None:
    """Write a model to its output; return it as written, or None after an error, which is reported."""
    from composer.bundle.licence_table import report_unlicensed
    from composer.bundle.output_error import OutputError

    clear_progress()
    report_unlicensed(made.licences, context)
    _judge_warnings(made, context)
    if context.strict and context.sink.has_errors:
        return None
    target = wanted.target(made.name, made.mujoco)
    try:
        _check_picture(made, target, wanted, context=context)
        if wanted.kind == "text" and made.built is not None:
            from composer.bundle.text_alone import text_alone

            composed = made.built.composed
            text = text_alone(composed.model, composed.files, target, folder=context.folder)
            made = maker.with_text(made, text, context)
        if not made.is_written:
            from composer.bundle.replaced import made_of

            out = place(context.folder, target)
            before = None if wanted.kind in ("text", "usd") else made_of(out)
            maker.note_written(
                made, _write(made, target, maker, wanted=wanted, context=context, session=session)
            )
            now = None if before is None else made_of(out)
            if before is not None and now is not None:
                made = replace(made, replaced=before.other_than(now))
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    _judge_warnings(made, context)
    return made


def _check_picture(made: Made, target: str, wanted: Wanted, context: Context) -> None:
    """Refuse a picture that would take the place of a texture. Raises OutputError."""
    if wanted.picturing is not None:
        from composer.bundle.staging import check_is_no_source
        from composer.cache.result import inputs_of

        check_is_no_source(context.folder / picture_beside(target, made.name), "--picture", inputs_of(made))


def add_picture(made: Made, wanted: Wanted, context: Context) -> None:
    """Draw a picture next to a written model, if one is wanted; errors go to the context's sink."""
    if wanted.picturing is not None:
        target = wanted.target(made.name, made.mujoco)
        wanted.picturing.put(target, made.name, is_known=made.is_written, context=context)


def _judge_warnings(made: Made, context: Context) -> None:
    """Drop warnings that the recipe allows; with `--strict` the rest become errors."""
    for diagnostic in context.sink.diagnostics:
        if diagnostic.severity is not Severity.ERROR and diagnostic.code in made.allowed:
            context.sink.drop(diagnostic)
    if context.strict:
        context.sink.promote()


def _write(
    made: Made, out: str, maker: Maker, wanted: Wanted, context: Context, session: Session | None
) -> tuple[Path, ...]:
    """Write the model, and return what was written elsewhere than to `out`."""
    from composer.bundle.staging import check_is_no_source
    from composer.cache.result import inputs_of

    if wanted.kind in ("text", "mjb", "usd") and made.bundle is not None:
        _check_holds_all(made.bundle, out)
    if out != "-":
        if is_address(out):
            _deliver(made, out, maker, wanted=wanted, context=context, session=session)
            return ()
        check_is_no_source(context.folder / out, "-o", inputs_of(made))
    if wanted.kind == "text":
        text = made.text
        assert text is not None
        if out != "-":
            from composer.bundle.staging import staged_file

            with staged_file(context.folder / out, "-o") as stage:
                stage.write_bytes(text)
        elif sys.stdout is None:
            raise OSError("standard output is closed")
        else:
            sys.stdout.buffer.write(text)
            sys.stdout.buffer.flush()
    elif wanted.kind == "folder with shared assets":
        from composer.bundle.shared import write_shared

        assert made.bundle is not None
        return write_shared(made.bundle, Path(os.path.abspath(context.folder / out)), wanted.assets_above)
    elif made.packed and made.record is not None:
        from composer.bundle.archive import write_packed

        write_packed(
            made.packed,
            made.record.model,
            Path(out),
            environment=context.environment,
            packed=made.packed.__getitem__,
        )
    else:
        from composer.bundle.write import write

        def lost(warning: str) -> None:
            context.sink.warning("usd-loss", f"`{out}` is not the whole model: {warning}")

        assert made.bundle is not None
        write(
            made.bundle, out, environment=context.environment, session=session, packing=maker.packing, warn=lost
        )  # fmt: skip
        if wanted.kind == "mjb":
            from composer.bundle.mjb import manifest_beside

            return (manifest_beside(Path(os.path.abspath(context.folder / out))),)
    return ()


def _deliver(
    made: Made, out: str, maker: Maker, wanted: Wanted, context: Context, session: Session | None
) -> None:
    """Write to this machine first, and then to an address."""
    from composer.bundle.remote import deliver_assets, deliver_file, deliver_folder
    from composer.bundle.shared import ASSETS
    from composer.scratch import scratch

    parts = out.rstrip("/").rsplit("/", wanted.assets_above)
    with scratch("output") as folder:
        models = folder / "models"
        local = models.joinpath(*parts[1:])
        _write(
            made,
            f"{local}/" if out.endswith("/") else str(local),
            maker,
            wanted=wanted,
            context=context,
            session=session,
        )
        if os.path.isdir(models / ASSETS):
            deliver_assets(models / ASSETS, f"{parts[0]}/{ASSETS}")
        if os.path.isdir(local):
            deliver_folder(local, out.rstrip("/"))
            return
        for each in sorted(local.parent.iterdir(), key=lambda each: each == local):
            deliver_file(each, f"{out.rpartition('/')[0]}/{each.name}")


def _check_holds_all(bundle: Bundle, out: str) -> None:
    """Refuse an output form that cannot hold worlds."""
    from composer.bundle.bundle import WORLDS
    from composer.bundle.output_error import OutputError

    if WORLDS in bundle.files:
        help = "write a folder or an archive, such as `-o build/{name}.zip`"
        raise OutputError("output-kind", f"`{out}` has no room for the worlds", help)
