"""A or B, as the user named it: a recipe, an MJCF file, a bundle, or one of a git revision."""

from __future__ import annotations

import json
import os
from contextlib import ExitStack
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import MJCF_FILES, RECIPES, URDF_FILES, foreign_format
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.sides.revision import check_out, split
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.reference import Trust


class OperandKind(StrEnum):
    RECIPE = "recipe"
    MJCF = "MJCF file"
    BUNDLE = "bundle"


class Operand(Struct):
    """A or B. `context` collects its own diagnostics and has the folder that displayed paths start from.

    For a git revision, `files` is the folder with its files. `given` is the model for which `path` is a recipe that
    mjcompose wrote; no message shows it.
    """

    label: str
    kind: OperandKind
    path: Path
    context: Context
    revision: str | None = None
    files: Path | None = None
    given: Path | None = None

    def located(self, span: Span) -> Span:
        """Return a place that anyone can look up: in a fetched source, or in a named revision."""
        name = self.fetched(self.context.folder / span.file)
        return self._in_revision(span) or span if name is None else replace(span, file=name)

    def fetched(self, path: Path) -> str | None:
        """Return a file by the reference that fetched it, or None for other files."""
        origin = self.context.fetching.around(path) if self.context.fetching is not None else None
        if origin is None or not origin.is_fetched:
            return None
        return origin.named(os.path.relpath(os.path.realpath(path), os.path.realpath(origin.root)))

    def report(self, sink: Sink) -> None:
        """Pass its own diagnostics on to another context."""
        for each in self.context.sink.sorted():
            seen = (note for note in each.notes if not self._is_written(note.span))
            notes = tuple(replace(note, span=self._in_revision(note.span)) for note in seen)
            span = each.span
            if self.given is not None and self._is_written(span):
                span = Span(self.context.shown(self.given), 1, 1)
            sink.add(replace(each, span=self._in_revision(span), notes=notes))

    def _is_written(self, span: Span | None) -> bool:
        """Return whether a place is in the recipe that mjcompose wrote for a model."""
        return self.given is not None and span is not None and self.context.folder / span.file == self.path

    def _in_revision(self, span: Span | None) -> Span | None:
        path = self.context.folder / (span.file if span is not None else "")
        if span is None or self.files is None or not path.is_relative_to(self.files):
            return span
        return replace(span, file=f"{self.revision}:{os.path.relpath(path, self.context.folder)}")


def read_operand(text: str, context: Context, opened: ExitStack) -> Operand | None:
    """Return the operand that `text` names, or None if there is none, which `context` reports.

    Temporary folders live as long as `opened`.
    """
    path = context.folder / text
    revision = None
    files = None
    own = replace(context, sink=Sink())
    if not os.path.exists(path) and (parts := split(text)) is not None:
        revision = parts[0]
        with context.sink:
            path, files, own = _of_revision(revision, parts[1], own, opened=opened)
        if files is None:
            return None
    if not os.path.exists(path):
        where = "" if revision is None else f" in revision `{revision}`"
        shown = text if revision is None else own.shown(path)
        help = None if revision is None else f"`git ls-tree -r --name-only {revision}` lists the files"
        context.sink.error("file-not-found", f"the file or folder `{shown}` does not exist{where}", help=help)
        return None
    kind = _kind(path)
    if kind is None:
        foreign = foreign_format(path)
        message = f"`{text}` is neither a recipe nor an MJCF or URDF file nor a bundle"
        help = "name a .yaml, .xml, .urdf, .xacro, .zip, .mjz or a folder, or one of a git revision as `REV:path`"
        if foreign is not None:
            message = foreign.message(text)
            help = foreign.help(text)
        context.sink.error("source-kind", message, help=help)
        return None
    given = path if path.suffix.lower() in URDF_FILES else None
    if given is not None:
        path = _recipe_of(path, opened)
    return Operand(text, kind, path, context=own, revision=revision, files=files, given=given)


def as_recipe(operand: Operand, opened: ExitStack) -> Operand:
    """Return an MJCF file as a recipe with it as base, which has a bundle; return other operands unchanged."""
    if operand.kind is not OperandKind.MJCF:
        return operand
    return replace(operand, kind=OperandKind.RECIPE, path=_recipe_of(operand.path, opened), given=operand.path)


def _recipe_of(path: Path, opened: ExitStack) -> Path:
    """Write a recipe with a model file as base: only composed models are converted."""
    recipe = Path(opened.enter_context(scratch("recipe")), f"{path.stem}.yaml")
    # JSON is valid YAML whatever characters the path contains.
    text = json.dumps({"recipe": 1, "base": os.path.abspath(path)}, ensure_ascii=False)
    recipe.write_text(text, encoding="utf-8")
    return recipe


def _of_revision(revision: str, path: str, context: Context, opened: ExitStack) -> tuple[Path, Path, Context]:
    """Return the path in a checkout of the revision, its root, and a context with the user's folder in it."""
    made = Path(os.path.realpath(opened.enter_context(scratch("revision"))))
    root, there = check_out(revision, context.folder / path, made, environment=context.environment)
    inside = os.path.relpath(there, root)
    named = os.path.normpath(path)
    folder = root
    if not Path(path).is_absolute() and ".." not in Path(path).parts and inside.endswith(named):
        folder = root / inside.removesuffix(named)
    # Its root counts as the root of the project, even without a file there that says so.
    return there, root, replace(context, folder=folder, fetching=Fetching(trust=Trust(files=(root,))))


def _kind(path: Path) -> OperandKind | None:
    suffix = path.suffix.lower()
    if os.path.isdir(path) or suffix in (".zip", ".mjz"):
        return OperandKind.BUNDLE
    if suffix in (*URDF_FILES, *RECIPES):
        return OperandKind.RECIPE
    return OperandKind.MJCF if suffix in MJCF_FILES else None
