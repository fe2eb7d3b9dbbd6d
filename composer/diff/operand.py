"""A or B as the user named it: a recipe, an MJCF file or a bundle, on disk or in a git revision."""

from __future__ import annotations

import json
import os
from contextlib import ExitStack
from dataclasses import replace
from enum import StrEnum
from pathlib import Path

from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diff.revision import RevisionError, check_out, split
from composer.reading.foreign import foreign_format
from composer.scratch import scratch
from composer.sources.fetching import Fetching
from composer.sources.trust import Trust

_URDF = (".urdf", ".xacro")


class Kind(StrEnum):
    RECIPE = "recipe"
    MJCF = "MJCF file"
    BUNDLE = "bundle"


@dataclass(frozen=True, slots=True)
class Operand:
    """A or B. `context` has a sink of its own and the folder that displayed paths start from.

    For a git revision, `files` is the folder with its files.
    """

    label: str
    kind: Kind
    path: Path
    context: Context
    revision: str | None = None
    files: Path | None = None

    def located(self, span: Span) -> Span:
        """Return a place that anybody can look up: in a fetched source, or in a named revision."""
        name = self.fetched(self.context.folder / span.file)
        return self._in_revision(span) if name is None else replace(span, file=name)

    def fetched(self, path: Path) -> str | None:
        """Return a file by the reference that fetched it, or None for other files."""
        origin = self.context.fetching.around(path) if self.context.fetching is not None else None
        if origin is None or not origin.is_fetched:
            return None
        return origin.named(os.path.relpath(os.path.realpath(path), os.path.realpath(origin.root)))

    def report(self, sink: Sink) -> None:
        """Pass the diagnostics of its own sink on to another one."""
        for diagnostic in self.context.sink.sorted():
            span = diagnostic.span
            notes = tuple(
                note if note.span is None else replace(note, span=self._in_revision(note.span))
                for note in diagnostic.notes
            )
            sink.add(replace(diagnostic, span=None if span is None else self._in_revision(span), notes=notes))

    def _in_revision(self, span: Span) -> Span:
        path = self.context.folder / span.file
        if self.files is None or not path.is_relative_to(self.files):
            return span
        return replace(span, file=f"{self.revision}:{os.path.relpath(path, self.context.folder)}")


def read_operand(text: str, context: Context, opened: ExitStack) -> Operand | None:
    """Return the operand that `text` names, or None if there is none, which is reported to the sink of `context`.

    Temporary folders live as long as `opened`.
    """
    path, revision, files, own = context.folder / text, None, None, replace(context, sink=Sink())
    if not os.path.exists(path) and (parts := split(text)) is not None:
        revision = parts[0]
        try:
            path, files, own = _of_revision(revision, parts[1], own, opened=opened)
        except RevisionError as error:
            context.sink.add(error.diagnostic)
            return None
    if not os.path.exists(path):
        where = "" if revision is None else f" in revision `{revision}`"
        shown = text if revision is None else own.shown(path)
        help = None if revision is None else f"`git ls-tree -r --name-only {revision}` lists what there is"
        context.sink.error("file-not-found", f"the file or folder `{shown}` does not exist{where}", help=help)
        return None
    kind = _kind(path)
    if kind is None and (foreign := foreign_format(path)) is not None:
        context.sink.error("source-kind", foreign.message(text), help=foreign.help(text))
        return None
    if kind is None:
        context.sink.error(
            "source-kind", f"`{text}` is neither a recipe nor an MJCF or URDF file nor a bundle",
            help="name a .yaml, .xml, .urdf, .xacro, .zip, .mjz or a folder, or one of a git revision as `REV:path`",
        )  # fmt: skip
        return None
    if path.suffix.lower() in _URDF:
        path = _recipe_of(path, opened)
    return Operand(text, kind, path, context=own, revision=revision, files=files)


def as_recipe(operand: Operand, opened: ExitStack) -> Operand:
    """Return an MJCF file as a recipe with this file as base, so that it has a bundle; other operands unchanged."""
    if operand.kind is not Kind.MJCF:
        return operand
    return replace(operand, kind=Kind.RECIPE, path=_recipe_of(operand.path, opened))


def _recipe_of(path: Path, opened: ExitStack) -> Path:
    """Write a recipe with a model file as base: only composed models are converted."""
    made = opened.enter_context(scratch("recipe"))
    recipe = Path(made, f"{path.stem}.yaml")
    # JSON is valid YAML whatever characters the path contains.
    text = json.dumps({"recipe": 1, "base": os.path.abspath(path)}, ensure_ascii=False)
    recipe.write_text(text, encoding="utf-8")
    return recipe


def _of_revision(revision: str, path: str, context: Context, opened: ExitStack) -> tuple[Path, Path, Context]:
    """Return the path in a checkout of the revision, its root, and a context with the user's folder in it."""
    made = opened.enter_context(scratch("revision"))
    tree = check_out(
        revision, context.folder / path, Path(os.path.realpath(made)), environment=context.environment
    )
    # Its root counts as the root of the project, even without a file there that says so.
    fetching = Fetching(trust=Trust(files=(tree.root,)))
    inside = os.path.relpath(tree.path, tree.root)
    if Path(path).is_absolute() or ".." in Path(path).parts or not inside.endswith(os.path.normpath(path)):
        return tree.path, tree.root, replace(context, folder=tree.root, fetching=fetching)
    here = tree.root / inside.removesuffix(os.path.normpath(path))
    return tree.path, tree.root, replace(context, folder=here, fetching=fetching)


def _kind(path: Path) -> Kind | None:
    if os.path.isdir(path):
        return Kind.BUNDLE
    kinds = {
        **dict.fromkeys(_URDF, Kind.RECIPE),
        ".yaml": Kind.RECIPE,
        ".yml": Kind.RECIPE,
        ".xml": Kind.MJCF,
        ".zip": Kind.BUNDLE,
        ".mjz": Kind.BUNDLE,
    }
    return kinds.get(path.suffix.lower())
