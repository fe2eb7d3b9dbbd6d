"""`mjcompose verify`: compare a bundle with its manifest, and its parts with their sources."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.options import STRICT, ReportOptions, TimeOptions
from mjcompose.cli.reporting import progress, say
from mjcompose.cli.run import PATH, Run, argument, command, group, option

if TYPE_CHECKING:
    from mjcompose.build.verify.stored import VerifiedBundle


@dataclass(frozen=True, slots=True)
class Options:
    bundles: tuple[Path, ...] = argument(metavar="BUNDLE...", type=PATH, nargs=-1, required=True)
    recipe: Path | None = option(
        "--recipe", type=PATH,
        help="The recipe that the bundle was built from, to find the sources of its parts.",
    )  # fmt: skip
    limits: TimeOptions = group(TimeOptions)
    strict: bool = STRICT
    reporting: ReportOptions = group(ReportOptions)


@command(Options)
def verify(options: Options, run: Run) -> int:
    """Verify each BUNDLE: a folder, .zip or .mjz.

    A bundle is valid if its files have the hashes in the manifest, MuJoCo compiles it, the order of joints, actuators,
    sensors and keyframes is that of the manifest, and every part is the same as its source alone.
    """
    from mjcompose.build.verify.stored import verify_stored
    from mjcompose.mujoco.engine import Session

    code, recipe = 0, options.recipe
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
        answer = {"bundle": path, "ok": ok, "sha256": stored.bundle.sha256, "parts": parts}
        click.echo(json.dumps(answer))
    elif form == "text" and ok:
        unchanged = sum(each.ok for each in stored.parts)
        compared = f", {unchanged} of {len(stored.parts)} parts compared with their sources and unchanged"
        say(f"{path}: ok: {len(stored.bundle.files)} files{compared if stored.parts else ', no parts'}")
