"""`mjcompose verify`: compare a bundle with its manifest, and its parts with their sources."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.cli.options import timeout_option
from mjcompose.cli.reporting import (
    exit_code,
    is_strict,
    progress,
    report,
    reporting_options,
    say,
    strict_option,
)

if TYPE_CHECKING:
    from mjcompose.build.verify.stored import VerifiedBundle


@click.command()
@click.argument("bundles", metavar="BUNDLE...", type=click.Path(path_type=Path), nargs=-1, required=True)
@click.option("--recipe", type=click.Path(path_type=Path),
              help="The recipe that the bundle was built from, to find the sources of its parts.")  # fmt: skip
@timeout_option
@strict_option
@reporting_options
def command(bundles: tuple[Path, ...], recipe: Path | None, form: str) -> None:
    """Verify each BUNDLE: a folder, .zip or .mjz.

    A bundle is valid if its files have the hashes in the manifest, MuJoCo compiles it, the order of joints, actuators,
    sensors and keyframes is that of the manifest, and every part is the same as its source alone.
    """
    from mjcompose.build.verify.stored import verify_stored
    from mjcompose.mujoco.engine import Session
    from mjcompose.sources.context import Context

    code = 0
    for bundle in bundles:
        context = Context(strict=is_strict())
        progress(f"verifying {bundle}")
        with Session() as session:
            stored = verify_stored(bundle, context, session, recipe=recipe)
        if context.strict:
            context.sink.promote()
        report(context, form)
        if context.sink.has_errors:
            code = max(code, exit_code(context.folder, [bundle, *([] if recipe is None else [recipe])]))
        if stored is not None:
            _say(stored, str(bundle), form, ok=not context.sink.has_errors)
    sys.exit(code)


def _say(stored: VerifiedBundle, path: str, form: str, *, ok: bool) -> None:
    if form == "json":
        parts = [
            {"part": each.member.part, "unchanged": None if each.obscure is not None else each.ok}
            for each in stored.parts
        ]
        answer = {"bundle": path, "ok": ok, "sha256": stored.bundle.sha256, "parts": parts}
        click.echo(json.dumps(answer))
    elif form == "text" and ok:
        unchanged = sum(each.ok for each in stored.parts)
        compared = f", {unchanged} of {len(stored.parts)} parts compared with their sources and unchanged"
        say(f"{path}: ok: {len(stored.bundle.files)} files{compared if stored.parts else ', no parts'}")
