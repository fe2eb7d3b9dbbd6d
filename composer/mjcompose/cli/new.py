"""`new` and `import`: write a starter recipe, a repository or the examples, or a recipe for a merged model."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import Struct
from mjcompose.base.files import RECIPES, URDF_FILES, foreign_format, own_name, read_regular
from mjcompose.base.report import as_lines, one_line
from mjcompose.base.words import counted
from mjcompose.bundle.bundle import OutputError, unwritable_error
from mjcompose.bundle.staging import staged_file
from mjcompose.cli.fmt import rewrite
from mjcompose.cli.options import ReportOptions, TimeOptions, output
from mjcompose.cli.reporting import FINDINGS, progress, say
from mjcompose.cli.run import PATH, Answer, Group, Run, Stop, argument, command, flag, group, option
from mjcompose.sources.context import Context, as_text

if TYPE_CHECKING:
    from mjcompose.tools.importing.recover import Recovered
    from mjcompose.tools.importing.search import Search


class NewOptions(Group):
    path: Path | None = argument(type=PATH, required=False)
    project: bool = flag(
        "--project",
        help="Write a repository to the folder PATH: recipe, lock, parts, CI and README. Existing files are kept.",
    )
    examples: bool = flag(
        "--examples",
        help="Write the recipes and models of the docs to the folder PATH (default: recipes). Existing files are kept.",
    )
    reporting: ReportOptions = group(ReportOptions)


@command(NewOptions, help="Write a commented starter recipe to PATH (default: model.yaml). It builds without changes.")
def new(options: NewOptions, run: Run) -> Answer | None:
    path = options.path
    context = run.context
    if options.project and options.examples:
        raise click.UsageError("--project and --examples exclude each other")
    try:
        if options.examples:
            outcome = _examples(path or Path("recipes"))
        elif options.project:
            outcome = _project(path, context)
        else:
            outcome = _recipe(path or Path("model.yaml"), context)
    except OutputError as error:
        context.sink.add(error.diagnostic)
    except OSError as error:
        context.sink.add(unwritable_error(path or Path("model.yaml"), error).diagnostic)
    if context.sink.has_errors:
        return None
    return Answer(outcome.words, {"wrote": list(outcome.wrote), "kept": list(outcome.kept)}, is_outcome=True)


class _Outcome(Struct):
    words: str
    wrote: tuple[str, ...]
    kept: tuple[str, ...]


def _recipe(path: Path, context: Context) -> _Outcome:
    from mjcompose.tools.new import starter

    if path.suffix.lower() not in RECIPES:
        shown = path.with_suffix(".yaml") if path.name else path / "model.yaml"
        raise click.UsageError(f"a recipe's name ends in .yaml: {shown}")
    if os.path.lexists(path):
        message = f"`{path}` exists already"
        context.sink.error("output-unwritable", message, help="choose another name, or remove the file")
        return _Outcome("", (), ())
    with staged_file(path) as stage:
        stage.write_text(starter(as_text(own_name(path))), encoding="utf-8")
    words = one_line(f"wrote {path}; build it with: mjcompose build {shlex.quote(str(path))}")
    return _Outcome(words, (str(path),), ())


def _project(folder: Path | None, context: Context) -> _Outcome:
    from importlib import metadata

    from mjcompose.language.schema import text as schema
    from mjcompose.tools.lock import write_lock
    from mjcompose.tools.new import needed, project, write_project

    if folder is None:
        raise click.UsageError("name the folder of the project: mjcompose new --project robots")
    title = as_text(os.path.basename(os.path.realpath(folder)))
    model = re.sub(r"[^\w-]+", "_", title).strip("_-") or "model"
    files = project(title, model, metadata.version("mujoco"), schema=schema())
    recipe = f"recipes/{model}.yaml"
    texts = {name: text.encode() for name, text in files.items()}
    written, kept = write_project(
        texts, needed(model), folder, finish=lambda stage: write_lock(stage / recipe, None, context)
    )
    start = f"start with {folder / 'README.md'}"
    if "README.md" in kept:
        start = f"build its model with: mjcompose build {shlex.quote(str(folder / recipe))}"
    words = [
        *(_kept(path, folder, files) for path in kept),
        f"wrote {counted(len(written), 'file')} to {folder}; {start}",
    ]
    return _outcome(words, folder, written, kept=kept)


def _examples(folder: Path) -> _Outcome:
    from mjcompose.language.schema import text as schema
    from mjcompose.tools.new import examples, write_project

    files = examples(schema())
    written, kept = write_project(files, (), folder, finish=lambda stage: None)
    own = [path for path in kept if read_regular(folder / path) != files[path]]
    start = f"look at one with: mjcompose view {shlex.quote(str(folder / 'demo.yaml'))}"
    words = [*(f"kept {folder / path}" for path in own), f"wrote {counted(len(written), 'file')} to {folder}; {start}"]
    return _outcome(words, folder, written, kept=kept)


def _outcome(words: Iterable[str], folder: Path, written: Iterable[str], kept: Iterable[str]) -> _Outcome:
    wrote, left = (tuple(str(folder / path) for path in paths) for paths in (written, kept))
    return _Outcome(as_lines(words), wrote, left)


def _kept(path: str, folder: Path, files: Mapping[str, str]) -> str:
    from mjcompose.tools.new import lacking

    kept = f"kept {folder / path}"
    if path not in files or not os.path.isfile(folder / path):
        return kept
    lines = lacking(path, read_regular(folder / path).decode("utf-8", "replace"), files[path])
    return f"{kept}; the project's own would have: {', '.join(f'`{line}`' for line in lines)}" if lines else kept


_SHOWN = 20
_CALIBRATION = "calibration"


class ImportOptions(Group):
    merged: Path = argument(type=PATH)
    parts: tuple[Path, ...] = argument(type=PATH, nargs=-1)
    folders: tuple[Path, ...] = option(
        "--among",
        multiple=True,
        metavar="FOLDER",
        type=click.Path(path_type=Path, exists=True, file_okay=False),
        help="If no PARTS are given, also search for them in this folder.",
    )
    out: str | None = output("Where to write the recipe. Default: MERGED.yaml in this folder.")
    limits: TimeOptions = group(TimeOptions)
    reporting: ReportOptions = group(ReportOptions)


@command(
    ImportOptions,
    help="""Propose a recipe that builds the model MERGED from the models PARTS, build it, and report the differences.

    Without PARTS, they are searched for in the folders of --among, in the Menagerie models on this machine, and in
    installed packages. If none are found, the recipe starts from MERGED itself, and corrects it if it is not valid
    alone.

    `import calibration FILE MODEL` writes a file of measurements from the calibration of a Universal Robots arm, for
    `measured: FILE` in the recipe of MODEL.

    From a URDF or a xacro template, write a recipe that starts from it, and print which elements are read and why.

    Parts are recognized by the names of their bodies, with or without a prefix. Anything that a recipe cannot express
    becomes a comment. Exit codes: 0 the recipe builds the same model, 1 something differs or cannot be read or built, 2
    wrong usage.
    """,
)
def import_(options: ImportOptions, run: Run) -> Answer | int:
    from mjcompose.tools.importing.recover import recover

    merged = options.merged
    parts = options.parts
    context = run.context
    if str(merged) == _CALIBRATION and not os.path.lexists(merged):
        return _calibration(options, run)
    target = Path(options.out) if options.out is not None else Path(f"{merged.stem}.yaml")
    if os.path.lexists(target):
        raise click.UsageError(f"{target} exists already: choose another name with -o")
    _check_parts(options)
    _refuse_foreign((merged, *parts), run)
    progress(f"reading {merged}")
    if merged.suffix.lower() in URDF_FILES:
        if parts or options.folders:
            raise click.UsageError("a URDF has no parts: remove PARTS and --among")
        return _urdf(merged, target, run)
    references: dict[Path, str] = {}
    if not parts and not options.folders and (corrected := _corrected(merged, target, run)) is not None:
        return corrected
    if not parts:
        result = _search(options, run)
        if not result.parts:
            return _whole(merged, target, among=_among(result), run=run)
        references = {part.path: part.reference for part in result.parts if part.reference is not None}
        parts = tuple(part.path for part in result.parts)
    found = recover(merged, list(parts), target, context=context, progress=progress, references=references)
    if found is not None:
        rewrite(target, found.text.encode(), context)
        context.sink.extend(found.faults)
    if found is None or context.sink.has_errors:
        raise Stop(run.code_of_failure(merged, *parts))
    return _answer(found, target, shown=context.shown(merged), run=run)


def _calibration(options: ImportOptions, run: Run) -> Answer:
    """Write the file of measurements of a calibration."""
    from mjcompose.tools.calibration import import_calibration

    if len(options.parts) != 2 or options.folders or options.out is None:
        raise click.UsageError("write `import calibration FILE MODEL -o robots/NAME.yaml`")
    file, model = options.parts
    target = Path(options.out)
    if os.path.lexists(target):
        raise click.UsageError(f"{target} exists already: choose another name with -o")
    found = run.need(import_calibration(file, str(model), target.stem, run.context), file, model)
    rewrite(target, found.text.encode(), run.context)
    run.check(run.code_of_failure(file, model))
    flange = f"; the site {found.flange} is the flange" if found.flange is not None else ""
    words = f"wrote {target}: the poses of {counted(found.bodies, 'body')}{flange}"
    answer = {"output": str(target), "bodies": found.bodies, "flange": found.flange}
    return Answer(words, answer, code=0, is_outcome=True)


def _check_parts(options: ImportOptions) -> None:
    if options.parts and options.folders:
        raise click.UsageError("--among is for a search, and you named PARTS: remove --among")
    for part in options.parts:
        if _is_reference(part):
            help = "Remove PARTS: mjcompose searches Menagerie and installed packages"
            raise click.UsageError(f"PARTS are files, and `{part}` is a reference. {help}")


def _search(options: ImportOptions, run: Run) -> Search:
    """Search the parts, and print those that were found."""
    from mjcompose.tools.importing.search import search

    result = run.need(search(options.merged, options.folders, run.context, progress=progress), options.merged)
    if result.parts:
        names = [part.reference or run.context.shown(part.path) for part in result.parts]
        say(f"found {counted(len(names), 'part')} {_among(result)}: {', '.join(names)}", err=run.form == "json")
    return result


def _among(result: Search) -> str:
    return f"among {counted(result.looked_at, 'model')}"


def _answer(found: Recovered, target: Path, shown: str, run: Run) -> Answer | int:
    from mjcompose.tools.importing.recover import changed, left

    comments = [entry for entry in found.proposal.entries if entry.note is not None]
    outcome = found.outcome
    edits = list(changed(found.proposal.changed))
    different = None if outcome is None else [] if outcome.same else list(left(outcome, shown))
    code = FINDINGS if outcome is None or not outcome.same else 0
    if run.form == "json":
        parts = {"parts": len(found.proposal.found), "comments": len(comments)}
        answer = {"output": str(target), **parts, "changed": edits, "differences": different}
        return Answer("", answer, code=code, is_outcome=True)
    run.report()
    only = f", {counted(len(comments), 'entry')} only as {'a comment' if len(comments) == 1 else 'comments'}"
    say(f"wrote {target}: {counted(len(found.proposal.found), 'part')}{only if comments else ''}")
    _say_several(f"changed in {shown}, and written into the recipe", edits)
    if outcome is None or different is None:
        why = f": MuJoCo rejects {shown}: {found.refused}" if found.refused else ""
        say(f"the two models could not be compared{why}")
    elif outcome.same:
        rounded = counted(len(outcome.rounded), "number")
        verb = "is" if len(outcome.rounded) == 1 else "are"
        but = f"; {rounded} {verb} equal to six digits only" if outcome.rounded else ""
        say(f"it builds, and the model equals {shown}, element by element, to seven digits{but}")
    else:
        _say_several(f"it builds, but does not yet match {shown}", different)
    return code


def _refuse_foreign(files: tuple[Path, ...], run: Run) -> None:
    for file in files:
        found = foreign_format(file)
        if found is not None:
            shown = run.context.shown(file)
            run.context.sink.error("source-kind", found.message(shown), help=found.help(shown))
        elif as_text(str(file)) != str(file):
            message = f"the name of `{file}` is not UTF-8, so a recipe cannot name it"
            run.context.sink.error("file-unreadable", message, help="rename it")
    run.check(run.code_of_failure(*files))


def _urdf(file: Path, target: Path, run: Run) -> Answer:
    """Write the recipe that starts from a URDF. Return the table of the elements that are read."""
    from mjcompose.tools.importing.propose import of_urdf, table

    context = run.context
    found = run.need(of_urdf(file, target, context), file)
    rewrite(target, found.text.encode(), context)
    run.check(run.code_of_failure(file))
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
    words = [f"wrote {target}: it starts from {context.shown(file)}", *table(found.rows)]
    return Answer(as_lines(words), {"output": str(target), "rows": rows}, code=0, is_outcome=True)


def _is_reference(part: Path) -> bool:
    """Return whether a file argument is a reference such as `menagerie:…`; a single letter is a drive."""
    return re.match(r"[a-z][a-z+]+:", str(part)) is not None and not os.path.exists(part)


def _whole(merged: Path, target: Path, among: str, run: Run) -> Answer:
    from mjcompose.tools.importing.recover import whole_recipe

    if not rewrite(target, whole_recipe(merged, target).encode(), run.context):
        raise Stop(FINDINGS)
    words = f"found none of its parts {among}; --among FOLDER looks further\n"
    words += f"wrote {target}: it starts from {run.context.shown(merged)} as it is"
    answer = {"output": str(target), "parts": 0, "comments": 0, "changed": [], "differences": []}
    aside = words if run.form == "json" else None
    return Answer(words, answer, code=0, is_outcome=True, reports=False, aside=aside)


def _corrected(file: Path, target: Path, run: Run) -> Answer | None:
    """Write the recipe that corrects a file which is not valid alone; None if the file needs no correction."""
    from mjcompose.tools.importing.recover import corrected_recipe, corrections_of

    corrections = corrections_of(file, run.context)
    if not corrections:
        return None
    if not rewrite(target, corrected_recipe(file, target, corrections).encode(), run.context):
        raise Stop(FINDINGS)
    words = [
        f"wrote {target}: it starts from {run.context.shown(file)}, which is not valid alone, and corrects it",
        *(f"  {each.text}" for each in corrections),
    ]
    answer = {"output": str(target), "parts": 0, "comments": 0, "changed": [], "differences": []}
    answer["corrections"] = [each.text for each in corrections]
    return Answer(as_lines(words), answer, code=0, is_outcome=True)


def _say_several(heading: str, lines: list[str]) -> None:
    if not lines:
        return
    say(f"{heading}:")
    for line in lines[:_SHOWN]:
        say(f"  {line}")
    if len(lines) > _SHOWN:
        say(f"  … and {len(lines) - _SHOWN} more")
