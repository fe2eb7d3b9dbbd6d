"""`mjcompose migrate`: a model that is written for one MuJoCo as one for another."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base.report import Paint
from mjcompose.cli import completing
from mjcompose.cli.fmt import difference, rewrite
from mjcompose.cli.options import fetching, fetching_options, output_option, timeout_option
from mjcompose.cli.reporting import (
    FINDINGS,
    exit_code,
    is_strict,
    progress,
    report,
    reporting_options,
    say,
    strict_option,
    use_color,
)

if TYPE_CHECKING:
    from mjcompose.sources.context import Context
    from mjcompose.tools.migrate.migrate import Result

_XML = (".xml", ".mjcf")
_RECIPES = (".yaml", ".yml")
_SHOWN = 5


@click.command()
@click.argument("model", shell_complete=completing.files)
@click.option("--from", "before", metavar="VERSION",
              help="The MuJoCo version that MODEL is written for, 3.0 to 4.0.")  # fmt: skip
@click.option("--mujoco", "after", metavar="VERSION",
              help="The MuJoCo version to write for, which may be older.  [default: the installed one]")  # fmt: skip
@output_option("Where to write the result: a new FILE.xml next to MODEL, or a new folder with all files.")
@click.option(
    "--in-place", is_flag=True, help="Write the changes to MODEL and the files that it includes or attaches."
)
@click.option("--adopt", multiple=True, metavar="CHANGE",
              help="Adopt a changed default instead of writing out the old one, as in --adopt native-ccd.")  # fmt: skip
@click.option("--with-python", "pythons", multiple=True, metavar="PATH", type=click.Path(path_type=Path),
              help="A Python with the other MuJoCo, to prove that the model stays the same.")  # fmt: skip
@click.option("--prove", is_flag=True,
              help="Prove that the model stays the same. Install the other MuJoCo into a separate"
              " environment if needed.")  # fmt: skip
@fetching_options
@timeout_option
@strict_option
@reporting_options
def command(
    model: str,
    before: str | None,
    after: str | None,
    out: str | None,
    in_place: bool,
    adopt: tuple[str, ...],
    pythons: tuple[Path, ...],
    prove: bool,
    form: str,
) -> None:
    """Rewrite MODEL, an MJCF file for one version of MuJoCo, for another version.

    Without -o and --in-place, the changes are only shown. The model keeps its meaning: attributes get their new names,
    and defaults that changed are written out. What cannot be kept is reported.

    Exit codes: 0 success, 1 changes are not written, something cannot be kept, or the model differs, 2 wrong usage.
    """
    from mjcompose.sources.context import Context
    from mjcompose.tools.migrate.changes import TABLE
    from mjcompose.tools.migrate.migrate import Wish, run

    _check_usage(model, out, in_place, adopt=adopt, changes=[each.name for each in TABLE])
    context = Context(fetching=fetching())
    progress(f"reading {model}")
    result = run(Wish(model, before, after, adopt=adopt, pythons=pythons, proves=prove), context, progress)
    if is_strict():
        context.sink.promote()
    written: Path | None = None
    is_whole = result is not None and not context.sink.has_errors
    if result is not None and is_whole and (out is not None or in_place):
        written = _written(result, out, context)
    if result is not None and form == "json":
        click.echo(json.dumps(_data(result, written, context), ensure_ascii=False))
    elif result is not None and is_whole and out is None and not in_place:
        _show(result, context)
    report(context, form)
    if result is None or context.sink.has_errors:
        sys.exit(exit_code(context.folder, [Path(model)] if ":" not in model else []))
    if form != "json":
        _say(result, written, in_place, context=context)
    left = bool(result.migrated.changed) and written is None
    sys.exit(FINDINGS if left or result.unexplained else 0)


def _check_usage(
    model: str, out: str | None, in_place: bool, adopt: tuple[str, ...], changes: list[str]
) -> None:
    from mjcompose.base.suggest import closest

    if Path(model).suffix.lower() in _RECIPES:
        raise click.UsageError(f"{model} is a recipe: migrate the models that it is made of")
    if out is not None and in_place:
        raise click.UsageError("--in-place writes into MODEL itself: leave -o out")
    if out is not None and os.path.lexists(out):
        raise click.UsageError(f"{out} exists already and is left as it is: choose another name with -o")
    for name in adopt:
        if name not in changes:
            near = closest(name, changes)
            meant = f" Did you mean `{near[0]}`?" if near else " `docs/migrate.md` lists them."
            raise click.UsageError(f"There is no change `{name}` to adopt.{meant}")


def _written(result: Result, out: str | None, context: Context) -> Path | None:
    """Write the files, all or none; where the model is now."""
    from mjcompose.build.bundle.bundle import OutputError
    from mjcompose.build.bundle.staging import staged_folder
    from mjcompose.tools.migrate.migrate import lay_out

    migrated, model = result.migrated, result.model
    if out is None:
        done = [rewrite(path, texts[1], context) for path, texts in migrated.changed.items()]
        return model if all(done) else None
    target = Path(out)
    if target.suffix.lower() in _XML:
        if (why := _bound(result, target)) is not None:
            context.sink.error("output-kind", f"`{out}` would not find its files: {why}",
                               help=f"write a folder: `-o {target.with_suffix('')}`")  # fmt: skip
            return None
        return target if rewrite(target, migrated.files[model][1], context, option="-o") else None
    try:
        with staged_folder(target, "-o") as stage:
            stage.mkdir()
            placed = lay_out(migrated, stage)[model].relative_to(stage)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    return target / placed


def _bound(result: Result, target: Path) -> str | None:
    """Why the model cannot be one file there."""
    migrated, model = result.migrated, result.model
    others = [path for path in migrated.changed if path != model]
    if others:
        return f"`{others[0].name}`, which it includes or attaches, is another one, too"
    same_place = os.path.realpath(target.parent) == os.path.realpath(model.parent)
    if not same_place and (migrated.assets or len(migrated.files) > 1):
        return "it would stand in another folder than they"
    return None


def _show(result: Result, context: Context) -> None:
    paint = Paint(use_color(out=True))
    for path, (before, after) in result.migrated.changed.items():
        for line in difference(before, after, context.shown(path), done="migrated").splitlines():
            style = {"+": "added", "-": "removed", "@": "gutter"}.get(line[:1])
            click.echo(paint(style, line) if style else line, color=use_color(out=True))


def _say(result: Result, written: Path | None, in_place: bool, context: Context) -> None:
    """What was done, and what is known of it."""
    migrated, proof = result.migrated, result.proof
    shown = context.shown(result.model)
    way = f"from MuJoCo {migrated.before} to {migrated.after}"
    count = f"{len(migrated.steps)} change{'s' * (len(migrated.steps) != 1)}"
    if not migrated.changed and (written is None or in_place):
        say(f"{shown} is the same text for MuJoCo {migrated.before} and {migrated.after}")
    elif written is None:
        say(f"can migrate {shown} {way} with {count}; `-o NEW.xml` or `--in-place` writes it")
    else:
        say(f"wrote {written}: {way} with {count}")
    outcome = proof.outcome
    if outcome is not None:
        arrays = len(outcome.equal) + len(outcome.rounded)
        but = f", {len(outcome.rounded)} of them up to rounding" if outcome.rounded else ""
        if outcome.same:
            say(f"proved: MuJoCo {migrated.after} compiles the same model; {arrays} arrays are equal{but}")
        elif not result.unexplained:
            say(f"compared: {arrays} arrays are equal{but}; what differs is said above:")
        for words in result.explained:
            say(f"  {words}")
        if outcome.recut:
            several = ", ".join(outcome.recut[:_SHOWN]) + (", …" if len(outcome.recut) > _SHOWN else "")
            say(f"  the same surface in other triangles: {several}")
        if outcome.apart:
            say(f"  not compared, for they have another form: {', '.join(outcome.apart)}")
    elif migrated.before != migrated.after:
        lack = " and ".join(result.missing)
        say(
            f"not proved: MuJoCo {lack} is not here; `--prove` installs it, `--with-python PATH` names one that has it"
        )


def _data(result: Result, written: Path | None, context: Context) -> dict[str, Any]:
    migrated, outcome = result.migrated, result.proof.outcome
    proof = None
    if outcome is not None:
        proof = {
            "same": outcome.same,
            "equal": len(outcome.equal),
            "rounded": outcome.rounded,
            "explained": result.explained,
            "unexplained": result.unexplained,
            "recut": outcome.recut,
            "not_compared": outcome.apart,
        }
    return {
        "from": migrated.before,
        "to": migrated.after,
        "output": None if written is None else str(written),
        "steps": [
            {
                "change": each.change,
                "place": None if each.span is None else str(each.span),
                "words": each.words,
            }
            for each in migrated.steps
        ],
        "diff": {
            context.shown(path): difference(before, after, context.shown(path), done="migrated")
            for path, (before, after) in migrated.changed.items()
        },
        "adopted": list(migrated.adopted),
        "proof": proof,
    }
