"""What the user named as A or B: a recipe, an MJCF file or a bundle, here or in a git revision."""

from __future__ import annotations

import json
import os
from contextlib import ExitStack
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diff.revision import RevisionError, check_out, split
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
    """A or B. `context` has a sink of its own and the folder that its paths are shown from.

    Of a git revision `files` is the folder that has them.
    """

    label: str
    kind: Kind
    path: Path
    context: Context
    revision: str | None = None
    files: Path | None = None

    def located(self, span: Span) -> Span:
        """A place as anybody may look it up: in what was fetched, or in a revision behind its name."""
        name = self.fetched(self.context.folder / span.file)
        return self._in_revision(span) if name is None else replace(span, file=name)

    def fetched(self, path: Path) -> str | None:
        """A file by the reference that it was fetched with; None for any other."""
        origin = self.context.fetching.around(path) if self.context.fetching is not None else None
        if origin is None or not origin.is_fetched:
            return None
        return origin.named(os.path.relpath(os.path.realpath(path), os.path.realpath(origin.root)))

    def report(self, sink: Sink) -> None:
        """Hand on what its own sink has been reported."""
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
    """What `text` means; None where it means nothing, which is reported to the sink of `context`.

    Temporary folders live as long as `opened`.
    """
    path, revision, files, own = context.folder / text, None, None, replace(context, sink=Sink())
    if not path.exists() and (parts := split(text)) is not None:
        revision = parts[0]
        try:
            path, files, own = _of_revision(revision, parts[1], own, opened)
        except RevisionError as error:
            context.sink.add(error.diagnostic)
            return None
    if not path.exists():
        where = "" if revision is None else f" in revision `{revision}`"
        shown = text if revision is None else own.shown(path)
        help = None if revision is None else f"`git ls-tree -r --name-only {revision}` lists what there is"
        context.sink.error("file-not-found", f"the file or folder `{shown}` does not exist{where}", help=help)
        return None
    kind = _kind(path)
    if kind is None:
        context.sink.error(
            "source-kind", f"`{text}` is neither a recipe nor an MJCF or URDF file nor a bundle",
            help="name a .yaml, .xml, .urdf, .xacro, .zip, .mjz or a folder, or one of a git revision as `REV:path`",
        )  # fmt: skip
        return None
    if path.suffix.lower() in _URDF:
        path = _recipe_of(path, opened)
    return Operand(text, kind, path, own, revision, files)


def as_recipe(operand: Operand, opened: ExitStack) -> Operand:
    """An MJCF file as a recipe that is this file and nothing else: it has a bundle then; anything else as it is."""
    if operand.kind is not Kind.MJCF:
        return operand
    return replace(operand, kind=Kind.RECIPE, path=_recipe_of(operand.path, opened))


def _recipe_of(path: Path, opened: ExitStack) -> Path:
    """A recipe that is a model file and nothing else: only what is composed is converted."""
    made = opened.enter_context(scratch("recipe"))
    recipe = Path(made, f"{path.stem}.yaml")
    # JSON is YAML, whatever characters the path has.
    text = json.dumps({"recipe": 1, "base": os.path.abspath(path)}, ensure_ascii=False)
    recipe.write_text(text, encoding="utf-8")
    return recipe


def _of_revision(revision: str, path: str, context: Context, opened: ExitStack) -> tuple[Path, Path, Context]:
    """The path below a folder that has the files of the revision, that, and the folder that stands for the user's."""
    made = opened.enter_context(scratch("revision"))
    tree = check_out(revision, context.folder / path, Path(os.path.realpath(made)), context.environment)
    # Its top is that of the project, without anything there that says so.
    fetching = Fetching(trust=Trust(files=(tree.root,)))
    inside = os.path.relpath(tree.path, tree.root)
    if Path(path).is_absolute() or ".." in Path(path).parts or not inside.endswith(os.path.normpath(path)):
        return tree.path, tree.root, replace(context, folder=tree.root, fetching=fetching)
    here = tree.root / inside.removesuffix(os.path.normpath(path))
    return tree.path, tree.root, replace(context, folder=here, fetching=fetching)


def _kind(path: Path) -> Kind | None:
    if path.is_dir():
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
