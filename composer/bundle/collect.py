"""The files of a linked model: read once, equal bytes stored once, every path in the model made to fit."""

from __future__ import annotations

import glob
import hashlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path

from composer.diagnostics.diagnostic import Cause
from composer.diagnostics.sink import Sink
from composer.diagnostics.suggest import closest
from composer.link.linking import FileUse
from composer.tree import lfs
from composer.tree.files import NAMED_AFTER_FILE, in_archive, stem
from composer.tree.unit import Unit


def collect(
    model: Unit, uses: Iterable[FileUse], sink: Sink, shown: Callable[[Path], str] = str
) -> dict[str, bytes]:
    """Bytes by path in the bundle. A file that is missing is told where the model names it, as `shown` calls it."""
    files: dict[str, bytes] = {}
    stored: dict[tuple[str, bytes], str] = {}
    stands_at: dict[str, str | None] = {}
    for use in uses:
        if use.path not in stands_at:
            stands_at[use.path] = _store(model, use, files, stored, sink, shown)
        path = stands_at[use.path]
        if path is None or path == use.path:
            continue
        if use.element.tag in NAMED_AFTER_FILE and not use.element.get("name"):
            use.element.set("name", stem(use.path))
        use.element.set(use.attribute, path)
    return files


def check_files(model: Unit, uses: Iterable[FileUse], sink: Sink, shown: Callable[[Path], str] = str) -> None:
    """Tell the files that are missing, of a model that will not be bundled for another fault."""
    for use in {use.path: use for use in uses if use.content is None}.values():
        try:
            os.stat(use.source)
        except OSError as error:
            _missing(model, use, error, sink, shown)


def read(model: Unit, use: FileUse, sink: Sink, shown: Callable[[Path], str] = str) -> bytes | None:
    """The bytes of a file; None where they cannot be had, which is told."""
    content = use.content
    if content is None:
        try:
            content = Path(use.source).read_bytes()
        except OSError as error:
            _missing(model, use, error, sink, shown)
            return None
    if lfs.is_pointer(content):
        called = f"`{shown(Path(use.source))}`"
        told = f"{called} is not the file itself but where Git LFS has it"
        span = model.origins.span(use.element, model.file, use.attribute)
        sink.error("asset-missing", told, span, help=lfs.HELP, cause=Cause(f"lfs: {span.file}", called))
        return None
    return content


def _store(
    model: Unit,
    use: FileUse,
    files: dict[str, bytes],
    stored: dict[tuple[str, bytes], str],
    sink: Sink,
    shown: Callable[[Path], str],
) -> str | None:
    """Where the bytes of a file are in the bundle: under its own path, or that of an equal file of its kind."""
    content = read(model, use, sink, shown)
    if content is None:
        return None
    if not use.shared:
        files[use.path] = content
        return use.path
    suffix = use.path.rsplit(".", 1)[-1]
    path = stored.setdefault((suffix, hashlib.sha256(content).digest()), use.path)
    if path == use.path:
        files[path] = content
    return path


def _missing(model: Unit, use: FileUse, error: OSError, sink: Sink, shown: Callable[[Path], str]) -> None:
    source = Path(use.source)
    message, help = f"the file `{shown(source)}` does not exist", None
    try:
        beside = sorted(os.listdir(source.parent))
    except OSError:
        beside = []
        if isinstance(error, FileNotFoundError):
            message += f", and neither does the folder `{shown(source.parent)}`"
    # What one folder lacks is one finding, unless each file needs a correction of its own.
    folder: Path | None = None
    if near := closest(source.name, beside):
        help = f"did you mean `{near[0]}`?"
    elif elsewhere := _elsewhere(source):
        help = f"there is one at `{shown(elsewhere)}`"
        folder = elsewhere.parent
    else:
        help = "compare the path with what is on the disk"
        folder = source.parent
    if not isinstance(error, FileNotFoundError):
        message, help = (
            f"the file `{shown(source)}` cannot be read: {(error.strerror or str(error)).lower()}",
            None,
        )
        folder = None
    archive = in_archive(source)
    if archive is not None:
        message, help = f"`{shown(archive[0])}` has no file `{archive[1]}`", None
    span = model.origins.span(use.element, model.file, use.attribute)
    cause = None
    if folder is not None:
        cause = Cause(f"{span.file}: {source.parent} {folder}", f"`{shown(source)}`")
    sink.error("asset-missing", message, span, help=help, cause=cause)


def _elsewhere(source: Path) -> Path | None:
    """A file of that name in a folder beside or below that of the missing one."""
    for folder in (source.parent, source.parent.parent):
        found = next(
            (path for path in sorted(folder.glob(f"*/{glob.escape(source.name)}")) if path.is_file()), None
        )
        if found is not None:
            return found
    return None
