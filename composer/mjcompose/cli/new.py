"""`mjcompose new`: write a starter recipe that builds as it is, a repository around one, or the examples."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.base.files import read_regular
from mjcompose.base.report import counted
from mjcompose.cli.options import ReportOptions
from mjcompose.cli.run import PATH, Answer, Run, argument, command, flag, group

if TYPE_CHECKING:
    from mjcompose.sources.context import Context


@dataclass(frozen=True, slots=True)
class Options:
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


@command(Options)
def new(options: Options, run: Run) -> Answer | None:
    """Write a commented starter recipe to PATH (default: model.yaml). It builds without changes."""
    from mjcompose.build.bundle.bundle import OutputError, unwritable_error

    path, context = options.path, run.context
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


@dataclass(frozen=True, slots=True)
class _Outcome:
    words: str
    wrote: tuple[str, ...]
    kept: tuple[str, ...]


def _recipe(path: Path, context: Context) -> _Outcome:
    from mjcompose.build.bundle.staging import staged_file
    from mjcompose.sources.context import as_text
    from mjcompose.tools.new import starter

    if path.suffix.lower() not in (".yaml", ".yml"):
        shown = path.with_suffix(".yaml") if path.name else path / "model.yaml"
        raise click.UsageError(f"a recipe's name ends in .yaml: {shown}")
    if os.path.lexists(path):
        message = f"`{path}` exists already"
        context.sink.error("output-unwritable", message, help="choose another name, or remove the file")
        return _Outcome("", (), ())
    with staged_file(path) as stage:
        stage.write_text(starter(as_text(path.stem)), encoding="utf-8")
    words = f"wrote {path}; build it with: mjcompose build {shlex.quote(str(path))}"
    return _Outcome(words, (str(path),), ())


def _project(folder: Path | None, context: Context) -> _Outcome:
    from importlib import metadata

    from mjcompose.language.schema import text as schema
    from mjcompose.sources.context import as_text
    from mjcompose.tools.lock import write_lock
    from mjcompose.tools.new import needed, project, write_project

    if folder is None:
        raise click.UsageError("name the folder of the project: mjcompose new --project robots")
    title = as_text(os.path.basename(os.path.realpath(folder)))
    model = re.sub(r"[^\w-]+", "_", title).strip("_-") or "model"
    files = project(title, model, metadata.version("mujoco"), schema=schema())
    recipe = f"recipes/{model}.yaml"
    written, kept = write_project(
        {name: text.encode() for name, text in files.items()},
        needed(model),
        folder,
        finish=lambda stage: write_lock(stage / recipe, None, context),
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
    return _Outcome("\n".join(words), wrote, left)


def _kept(path: str, folder: Path, files: Mapping[str, str]) -> str:
    from mjcompose.tools.new import lacking

    kept = f"kept {folder / path}"
    if path not in files or not os.path.isfile(folder / path):
        return kept
    lines = lacking(path, read_regular(folder / path).decode("utf-8", "replace"), files[path])
    return f"{kept}; the project's own would have: {', '.join(f'`{line}`' for line in lines)}" if lines else kept
