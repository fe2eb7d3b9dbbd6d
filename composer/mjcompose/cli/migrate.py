"""`migrate` and `upgrade`: the text and the motion of a model in another version of MuJoCo."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from mjcompose.base.access import door_of_named
from mjcompose.base.files import MJCF_FILES, RECIPES
from mjcompose.base.report import as_lines, json_text
from mjcompose.base.words import counted
from mjcompose.bundle.staging import staged_folder
from mjcompose.cli import completion
from mjcompose.cli.fmt import difference, rewrite, show_differences
from mjcompose.cli.options import STRICT, Amount, FetchOptions, ReportOptions, TimeOptions, did_you_mean, output
from mjcompose.cli.reporting import FINDINGS, progress
from mjcompose.cli.run import PATH, Answer, Group, Run, Stop, argument, command, flag, group, option
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.tools.migrate.migrate import Result
    from mjcompose.tools.migrate.upgrade import Upgrade


_SHOWN = 5


class MigrateOptions(Group):
    model: str = argument(shell_complete=completion.files)
    before: str | None = option(
        "--from", metavar="VERSION", help="The MuJoCo version that MODEL is written for, 3.0 to 4.0."
    )
    after: str | None = option(
        "--mujoco",
        metavar="VERSION",
        help="The MuJoCo version to write for, which may be older.  [default: the installed one]",
    )
    out: str | None = output("Where to write the result: a new FILE.xml next to MODEL, or a new folder with all files.")
    in_place: bool = flag("--in-place", help="Write the changes to MODEL and the files that it includes or attaches.")
    adopt: tuple[str, ...] = option(
        "--adopt",
        multiple=True,
        metavar="CHANGE",
        help="Adopt a changed default instead of writing out the old one, as in --adopt native-ccd.",
    )
    pythons: tuple[Path, ...] = option(
        "--with-python",
        multiple=True,
        metavar="PATH",
        type=PATH,
        help="A Python with the other MuJoCo, to prove that the model stays the same.",
    )
    prove: bool = flag(
        "--prove",
        help="Prove that the model stays the same, with the other MuJoCo that `mjcompose install` has installed.",
    )
    fetching: FetchOptions = group(FetchOptions)
    limits: TimeOptions = group(TimeOptions)
    strict: bool = STRICT
    reporting: ReportOptions = group(ReportOptions)


@command(
    MigrateOptions,
    help="""Rewrite MODEL, an MJCF file for one version of MuJoCo, for another version.

    Without -o and --in-place, the changes are only shown. The model keeps its meaning: attributes get their new names,
    and defaults that changed are written out. Anything that cannot be kept is reported.

    Exit codes: 0 success, 1 changes are not written, something cannot be kept, or the model differs, 2 wrong usage.
    """,
)
def migrate(options: MigrateOptions, run: Run) -> Answer | int:
    from mjcompose.tools.migrate.migrate import MigrateRequest, run as migrated

    _check_usage(options)
    model = options.model
    out = options.out
    context = run.context
    progress(f"reading {model}")
    wish = MigrateRequest(
        model, options.before, options.after, adopt=options.adopt, pythons=options.pythons, proves=options.prove
    )
    result = migrated(wish, context, progress)
    if run.is_strict:
        context.sink.promote()
    files = [Path(model)] if ":" not in model else []
    if result is None:
        raise Stop(run.code_of_failure(*files))
    is_whole = not context.sink.has_errors
    writes = out is not None or options.in_place
    written = _written(result, out, context) if is_whole and writes else None
    if run.form == "json":
        click.echo(json_text(_data(result, written, context), ensure_ascii=False))
    elif is_whole and not writes:
        show_differences(result.migrated.changed, context, done="migrated")
    if context.sink.has_errors:
        raise Stop(run.code_of_failure(*files))
    code = FINDINGS if (result.migrated.changed and written is None) or result.unexplained else 0
    if run.form == "json":
        return code
    words = as_lines(_lines(result, written, options.in_place, context=context))
    return Answer(words, code=code, is_outcome=True)


def _check_usage(options: MigrateOptions) -> None:
    from mjcompose.tools.migrate.changes import TABLE

    model = options.model
    out = options.out
    changes = [each.name for each in TABLE]
    if Path(model).suffix.lower() in RECIPES:
        raise click.UsageError(f"{model} is a recipe: migrate its models instead")
    if out is not None and options.in_place:
        raise click.UsageError("--in-place writes into MODEL itself: remove -o")
    if out is not None and os.path.lexists(out):
        raise click.UsageError(f"{out} exists already: choose another name with -o")
    for name in options.adopt:
        if name not in changes:
            hint = did_you_mean(name, changes, " `docs/how-to/upgrade_mujoco.md` lists them.")
            raise click.UsageError(f"There is no change `{name}` to adopt.{hint}")


def _written(result: Result, out: str | None, context: Context) -> Path | None:
    """Write all files or none. Return the path of the model."""
    from mjcompose.tools.migrate.migrate import lay_out

    migrated = result.migrated
    model = result.model
    if out is None:
        door = door_of_named(model)
        done = [rewrite(path, texts[1], context, within=door) for path, texts in migrated.changed.items()]
        return model if all(done) else None
    target = Path(out)
    if target.suffix.lower() in MJCF_FILES:
        why = _bound(result, target)
        if why is not None:
            context.sink.error(
                "output-kind",
                f"`{out}` would not find its files: {why}",
                help=f"write a folder: `-o {target.with_suffix('')}`",
            )
            return None
        return target if rewrite(target, migrated.files[model][1], context, option="-o") else None
    placed = None
    with context.sink, staged_folder(target, "-o") as stage:
        stage.mkdir()
        placed = lay_out(migrated, stage)[model].relative_to(stage)
    return None if placed is None else target / placed


def _bound(result: Result, target: Path) -> str | None:
    """The reason that the model cannot be one file in that folder."""
    migrated = result.migrated
    model = result.model
    others = [path for path in migrated.changed if path != model]
    if others:
        return f"`{others[0].name}`, which it includes or attaches, changes too"
    same_place = os.path.realpath(target.parent) == os.path.realpath(model.parent)
    if not same_place and (migrated.assets or len(migrated.files) > 1):
        return "it would be in another folder"
    return None


def _lines(result: Result, written: Path | None, in_place: bool, context: Context) -> Iterator[str]:
    migrated = result.migrated
    proof = result.proof
    shown = context.shown(result.model)
    way = f"from MuJoCo {migrated.before} to {migrated.after}"
    count = counted(len(migrated.steps), "change")
    if not migrated.changed and (written is None or in_place):
        yield f"{shown} is the same text for MuJoCo {migrated.before} and {migrated.after}"
    elif written is None:
        yield f"can migrate {shown} {way} with {count}; `-o NEW.xml` or `--in-place` writes it"
    else:
        yield f"wrote {written}: {way} with {count}"
    outcome = proof.outcome
    if outcome is not None:
        arrays = len(outcome.equal) + len(outcome.rounded)
        but = f", {len(outcome.rounded)} of them up to rounding" if outcome.rounded else ""
        if outcome.same:
            yield f"proved: MuJoCo {migrated.after} compiles the same model; {arrays} arrays are equal{but}"
        elif not result.unexplained:
            yield f"compared: {arrays} arrays are equal{but}; the differences are above:"
        yield from (f"  {words}" for words in result.explained)
        if outcome.recut:
            several = ", ".join(outcome.recut[:_SHOWN]) + (", …" if len(outcome.recut) > _SHOWN else "")
            yield f"  the same surface with different triangles: {several}"
        if outcome.apart:
            yield f"  not compared because their form differs: {', '.join(outcome.apart)}"
    elif migrated.before != migrated.after:
        lack = " ".join(f"mujoco=={version}" for version in result.missing)
        yield f"not proved: `--prove` compares both versions after `mjcompose install {lack}`"


def _data(result: Result, written: Path | None, context: Context) -> dict[str, Any]:
    migrated = result.migrated
    outcome = result.proof.outcome
    proof: dict[str, Any] | None = None
    if outcome is not None:
        proof = {"same": outcome.same, "equal": len(outcome.equal), "rounded": outcome.rounded}
        proof |= {"explained": result.explained, "unexplained": result.unexplained}
        proof |= {"recut": outcome.recut, "not_compared": outcome.apart}
    places = [None if each.span is None else str(each.span) for each in migrated.steps]
    steps = zip(migrated.steps, places, strict=True)
    texts = {context.shown(path): texts for path, texts in migrated.changed.items()}
    return {
        "from": migrated.before,
        "to": migrated.after,
        "output": None if written is None else str(written),
        "steps": [{"change": each.change, "place": place, "words": each.words} for each, place in steps],
        "diff": {shown: difference(*both, shown, done="migrated") for shown, both in texts.items()},
        "adopted": list(migrated.adopted),
        "proof": proof,
    }


class UpgradeOptions(Group):
    model: str = argument(shell_complete=completion.files)
    before: str = option("--from", metavar="VERSION", required=True, help="The MuJoCo version that you use now.")
    after: str | None = option(
        "--to", metavar="VERSION", help="The MuJoCo version to use.  [default: the installed one]"
    )
    seconds: float = option(
        "--seconds",
        type=Amount(0, 60, min_open=True),
        default=2.0,
        show_default=True,
        help="The length of each simulation.",
    )
    tolerance: float = option(
        "--tol",
        type=Amount(0),
        default=1e-3,
        show_default=True,
        help="The distance up to which motions are the same, in m or rad.",
    )
    key: str | None = option("--key", help="The keyframe to hold, step and drop from.  [default: the first one]")
    pythons: tuple[Path, ...] = option(
        "--with-python", multiple=True, metavar="PATH", type=PATH, help="A Python with one of the two versions."
    )
    fetching: FetchOptions = group(FetchOptions)
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    UpgradeOptions,
    help="""Show how MODEL, an MJCF file, moves differently in another version of MuJoCo, and which line causes it.

    Four trials run in both versions: the model settles from its reference configuration, holds a keyframe, gets a step
    of all controls, and drops without actuators. `mjcompose install` installs other versions.

    Exit codes: 0 the model moves the same, 1 something moves differently or fails, 2 wrong usage.
    """,
)
def upgrade(options: UpgradeOptions, run: Run) -> Answer:
    from mjcompose.tools.migrate.upgrade import UpgradeRequest, upgrade as upgraded

    if Path(options.model).suffix.lower() in RECIPES:
        help = f"in the recipe, write `check: {{moves: {{moves_alike: mujoco=={options.before}}}}}`"
        raise click.UsageError(f"{options.model} is a recipe: {help}")
    request = UpgradeRequest(
        options.model,
        options.before,
        options.after,
        seconds=options.seconds,
        tolerance=options.tolerance,
        key=options.key,
        pythons=options.pythons,
    )
    found = upgraded(request, run.context, progress)
    if found is None:
        raise Stop(run.code_of_failure(Path(options.model)))
    data = {
        "model": options.model,
        "from": found.before,
        "to": found.after,
        "trials": list(found.trials),
        "moved": [each.data() for each in found.moved],
        "diverged": list(found.diverged),
        "inertias": list(found.inertias),
    }
    code = FINDINGS if found.moved or found.diverged else 0
    return Answer(as_lines(_motions(options, found)), data, code=code, is_outcome=True)


def _unlike(found: Upgrade) -> str:
    """Return the words for a difference that no line of the model causes."""
    if not found.inertias:
        return "solves or collides differently"
    listed = ", ".join(f"`{name}`" for name in found.inertias[:_SHOWN])
    more = f" and {len(found.inertias) - _SHOWN} more" if len(found.inertias) > _SHOWN else ""
    return f"compiles another mass or inertia of {listed}{more}"


def _motions(options: UpgradeOptions, found: Upgrade) -> Iterator[str]:
    way = f"from MuJoCo {found.before} to {found.after}"
    trials = ", ".join(found.trials)
    if not found.moved:
        yield f"{options.model} moves the same {way}, within {options.tolerance:g} m or rad, in {trials}"
    else:
        yield f"{options.model} {way}: {counted(len(found.moved), 'difference')} in {trials}"
    for each in found.moved:
        yield f"  {each.moved.words}"
        for step in each.steps:
            yield f"    cause: {step.span or options.model}: {step.change}, which `migrate` undoes: {step.words}"
        for meaning in each.suspects:
            yield f"    perhaps: {meaning.span or options.model}: {meaning.change}: {meaning.message}"
        if not each.steps and not each.suspects:
            yield f"    cause: no line of the model; MuJoCo {_unlike(found)}"
    for trial in found.diverged:
        yield f"  the simulation diverges in `{trial}`"
