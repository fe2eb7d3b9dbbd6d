"""What the user named as A or B: a recipe, an MJCF file or a bundle, here or in a git revision."""

from __future__ import annotations

import os
import tempfile
from contextlib import ExitStack
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.diff.revision import RevisionError, check_out, split


class Kind(StrEnum):
    RECIPE = "recipe"
    MJCF = "MJCF file"
    BUNDLE = "bundle"


@dataclass(frozen=True, slots=True)
class Operand:
    """A or B. `context` has a sink of its own and the folder that its paths are shown from."""

    label: str
    kind: Kind
    path: Path
    context: Context
    revision: str | None = None

    def located(self, span: Span) -> Span:
        """A place as the user may look it up: in a revision behind its name."""
        return span if self.revision is None else replace(span, file=f"{self.revision}:{span.file}")

    def tell(self, sink: Sink) -> None:
        """Hand on what its own sink has been told."""
        for diagnostic in self.context.sink.sorted():
            span = diagnostic.span
            notes = tuple(
                note if note.span is None else replace(note, span=self.located(note.span))
                for note in diagnostic.notes
            )
            sink.add(replace(diagnostic, span=None if span is None else self.located(span), notes=notes))


def read_operand(text: str, context: Context, opened: ExitStack) -> Operand | None:
    """What `text` means; None where it means nothing, which is told to the sink of `context`.

    Temporary folders live as long as `opened`.
    """
    path, revision, own = context.folder / text, None, replace(context, sink=Sink())
    if not path.exists() and (parts := split(text)) is not None:
        revision = parts[0]
        try:
            path, own = _of_revision(revision, parts[1], own, opened)
        except RevisionError as error:
            context.sink.error(error.code, error.message, help=error.help)
            return None
    if not path.exists():
        where = "" if revision is None else f" in revision `{revision}`"
        shown = text if revision is None else own.shown(path)
        help = None if revision is None else f"`git ls-tree -r --name-only {revision}` lists what there is"
        context.sink.error("file-not-found", f"there is no file or folder `{shown}`{where}", help=help)
        return None
    kind = _kind(path)
    if kind is None:
        context.sink.error(
            "source-kind", f"`{text}` is neither a recipe nor an MJCF file nor a bundle",
            help="name a .yaml, .xml, .zip, .mjz or a folder, or one of a git revision as `REV:path`",
        )  # fmt: skip
        return None
    return Operand(text, kind, path, own, revision)


def _of_revision(revision: str, path: str, context: Context, opened: ExitStack) -> tuple[Path, Context]:
    """The path below a folder that has the files of the revision, and the folder that stands for the user's."""
    made = opened.enter_context(tempfile.TemporaryDirectory(prefix="mjcompose-revision-"))
    tree = check_out(revision, context.folder / path, Path(made).resolve(), context.environment)
    inside = os.path.relpath(tree.path, tree.root)
    if Path(path).is_absolute() or ".." in Path(path).parts or not inside.endswith(os.path.normpath(path)):
        return tree.path, replace(context, folder=tree.root)
    here = tree.root / inside.removesuffix(os.path.normpath(path))
    return tree.path, replace(context, folder=here)


def _kind(path: Path) -> Kind | None:
    if path.is_dir():
        return Kind.BUNDLE
    kinds = {
        ".yaml": Kind.RECIPE,
        ".yml": Kind.RECIPE,
        ".xml": Kind.MJCF,
        ".zip": Kind.BUNDLE,
        ".mjz": Kind.BUNDLE,
    }
    return kinds.get(path.suffix.lower())
