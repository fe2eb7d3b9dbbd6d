"""The files of a linked model, each read and stored once."""

from __future__ import annotations

import glob
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from pathlib import Path

from mjcompose.base.diagnostic import Cause, Note, Span
from mjcompose.base.files import Refused, read_regular
from mjcompose.base.limits import advice, in_force, written
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest
from mjcompose.link.files import NAMED_AFTER
from mjcompose.link.linking import FileUse
from mjcompose.tree import journal, xml_faults
from mjcompose.tree.files import NAMED_AFTER_FILE, in_archive, stem
from mjcompose.tree.journal import because
from mjcompose.tree.unit import Unit

_STORED = because("a file with the same bytes is in the bundle already")


def collect(model: Unit, uses: Iterable[FileUse], sink: Sink, shown: Callable[[Path], str] = str) -> dict[str, bytes]:
    """Return the bytes by path in the bundle. Missing files are reported at `shown`, where the model names them."""
    files: dict[str, bytes] = {}
    stored: dict[tuple[str, bytes], str] = {}  # shared files, by suffix and content: an equal file is stored once
    paths: dict[str, str | None] = {}
    limits = in_force()
    size = 0
    for use in uses:
        if use.path not in paths:
            with suppress(OSError):  # unreadable files are reported when they are read
                size += os.stat(use.source).st_size if use.content is None else len(use.content)
            over = "output-files" if len(paths) + 1 >= limits.output_files else "output-size"
            if over == "output-files" or size > limits.output_size:
                most = written(over, getattr(limits, over.replace("-", "_")))
                of = "files" if over == "output-files" else "in its files"
                message = f"the bundle would have more than {most} {of}"
                span = model.origins.span(use.element, model.file, use.attribute)
                sink.error("limit-exceeded", message, span, help=advice(over))
                break
            content = read(model, use, sink, shown=shown)
            paths[use.path] = None if content is None else use.path
            if content is not None:
                if use.shared:
                    paths[use.path] = stored.setdefault((use.path.rsplit(".", 1)[-1], content), use.path)
                files[str(paths[use.path])] = content
        if (path := paths[use.path]) is None or path == use.path:
            continue
        if use.element.tag in NAMED_AFTER_FILE and not use.element.get("name"):
            journal.write(use.element, "name", stem(use.path), NAMED_AFTER)
        journal.write(use.element, use.attribute, path, _STORED)
    return files


def check_files(model: Unit, uses: Iterable[FileUse], sink: Sink, shown: Callable[[Path], str] = str) -> None:
    """Report missing files of a model that will not be bundled because of another fault."""
    for use in {use.path: use for use in uses if use.content is None}.values():
        try:
            os.stat(use.source)
        except OSError as error:
            _missing(model, use, error, sink=sink, shown=shown)


def read(model: Unit, use: FileUse, sink: Sink, shown: Callable[[Path], str] = str) -> bytes | None:
    """Return the bytes of a file, or None if it is unreadable, which is reported."""
    if (content := use.content) is None:
        try:
            content = read_regular(use.source)
        except Refused as refused:
            refused.report(sink, model.origins.span(use.element, model.file, use.attribute), shown=shown)
            return None
        except OSError as error:
            _missing(model, use, error, sink=sink, shown=shown)
            return None
    if xml_faults.is_pointer(content):
        called = f"`{shown(Path(use.source))}`"
        message = f"{called} is not the file itself but where Git LFS has it"
        span = model.origins.span(use.element, model.file, use.attribute)
        sink.error("asset-missing", message, span, help=xml_faults.HELP, cause=Cause(f"lfs: {span.file}", called))
        return None
    return content


_LOOKED_FOR = 100
"""The number of missing files for which mjcompose searches for the same name, reading a folder each time."""


def _missing(model: Unit, use: FileUse, error: OSError, sink: Sink, shown: Callable[[Path], str]) -> None:
    source = Path(use.source)
    message = f"the file `{shown(source)}` does not exist"
    help = None
    try:
        beside = sorted(os.listdir(source.parent)) if sink.error_count < _LOOKED_FOR else []
    except OSError:
        beside = []
        if isinstance(error, FileNotFoundError):
            message += f", and neither does the folder `{shown(source.parent)}`"
    # Missing files of one folder are one finding, unless they need different corrections.
    folder: Path | None = None
    span = model.origins.span(use.element, model.file, use.attribute)
    included = _folder_of_include(model, span, source)
    notes: tuple[Note, ...] = ()
    if included is not None:
        rule = "MuJoCo looks from the folder of the model that includes it, and then next to it"
        notes = (Note(f"`{span.file}` is an included file: {rule}"),)
    if near := closest(source.name, beside):
        # The tree of a URDF has the written path; the tree of a model already has the path in the bundle.
        written = str(use.element.get("filename") or "") if use.attribute == "filename" else ""
        help = f"did you mean `{''.join(written.rpartition('/')[:2])}{near[0]}`?"
    elif sink.error_count < _LOOKED_FOR and (elsewhere := _found_elsewhere(source, included)):
        help = f"there is one at `{shown(elsewhere)}`"
        folder = elsewhere.parent
    else:
        help = "compare the path with what is on the disk"
        folder = source.parent
    if not isinstance(error, FileNotFoundError):
        message = f"the file `{shown(source)}` cannot be read: {(error.strerror or str(error)).lower()}"
        help = None
        folder = None
    if (archive := in_archive(source)) is not None:
        message = f"`{shown(archive[0])}` has no file `{archive[1]}`"
        help = None
    cause = None
    if folder is not None:
        cause = Cause(f"{span.file}: {source.parent} {folder}", f"`{shown(source)}`")
    sink.error("asset-missing", message, span, notes=notes, help=help, cause=cause)


def _folder_of_include(model: Unit, span: Span, source: Path) -> Path | None:
    """Return the folder of the file that names a missing file, if MuJoCo looks for the missing file elsewhere."""
    text = model.origins.texts.get(span.file)
    folder = None if text is None or text.path is None else text.path.parent
    return None if folder is None or folder in source.parents else folder


def _found_elsewhere(source: Path, included: Path | None = None) -> Path | None:
    """Return a file of the same name in a folder next to or below the folder of the missing file, or `included`."""
    for folder in (source.parent, source.parent.parent, *([] if included is None else [included])):
        with suppress(OSError):  # a name that is too long, or an unreadable folder
            for path in sorted(folder.glob(f"*/{glob.escape(source.name)}")):
                if os.path.isfile(path):
                    return path
    return None
