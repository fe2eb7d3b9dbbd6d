"""Read a bundle from a folder or an archive that may come from anyone.

An untrusted bundle reads only its own files, and no more of them than the limits allow. The files that its model names
are checked before MuJoCo opens it.
"""

from __future__ import annotations

import json
import lzma
import os
import posixpath
import re
import stat
import struct
import zipfile
import zlib
from io import BytesIO
from pathlib import Path

from mjcompose.base.access import Door
from mjcompose.base.diagnostic import Diagnostic, DiagnosticError
from mjcompose.base.files import MJCF_FILES, open_regular, read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import MANIFEST, MODEL, Bundle, BundleError, check_paths, raise_error
from mjcompose.tree.parse import all_admitted, parse_file, parse_text

ZIP_FAULTS: tuple[type[Exception], ...] = (
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    struct.error,
    NotImplementedError,  # a compression method that Python lacks
    RuntimeError,  # an encrypted file
    EOFError,
    OverflowError,
    ValueError,  # names that are not text, offsets below zero, damaged bzip2
)


_CODES = ("source-outside", "limit-exceeded")


def files_outside(folder: Path, model: str, shown: str) -> tuple[Diagnostic, ...]:
    """Return the faults in the files that a model in `folder` names, in their sizes, or in its XML; usually none."""
    if not model.lower().endswith(".xml"):
        return ()
    path = folder / model
    sink = Sink()
    found = Sink()

    def name(file: Path) -> str:
        return f"{shown}/{Path(os.path.relpath(os.path.abspath(file), os.path.abspath(folder))).as_posix()}"

    door = Door.of([folder], f"the bundle `{shown}`, which may read only itself")
    unit = parse_file(path, sink, file=f"{shown}/{model}", door=door)
    if unit is not None:
        all_admitted(unit, found, name)
    refused = tuple(each for each in (*sink.errors, *found.errors) if each.code in _CODES)
    return refused or (() if unit is not None else tuple(each for each in sink.errors if each.code == "xml-syntax"))


_ROOT = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:<\?.*?\?>\s*|<!.*?-->\s*)*<mujoco[\s>/]", re.DOTALL)
_EXPANDS = re.compile(rb"<(replicate|flexcomp|composite)\b")
_NAMED = re.compile(rb"""<(?:include|model)\s[^>]*?file\s*=\s*["']([^"']*)["']""")


_NO_BUNDLE = {
    ".mjb": "MuJoCo's binary form, not a bundle: load it with `mjcompose.load`",
    **dict.fromkeys(MJCF_FILES, "text alone, which has no manifest: a bundle is a folder, a `.zip` or an `.mjz`"),
}


class ReadError(DiagnosticError):
    """The reason why a bundle cannot be read."""


def read(path: Path, shown: str | None = None, content: bytes | None = None) -> Bundle:
    """Return the bundle in a folder, a zip or an MJZ. Raises ReadError, with `shown` as the path in messages.

    `content` are the bytes of an archive that was read already. Links, paths that lead out, encrypted files and files
    beyond the limits are refused before anything is decompressed. The model is the one in the manifest, or else
    `model.xml`, `STEM.xml`, or the only model that no other model names.
    """
    shown = shown or str(path)
    try:
        if path.is_dir():
            files = _read_folder(path, shown)
        elif not path.exists():
            raise ReadError("file-not-found", f"the file or folder `{shown}` does not exist")
        elif (what := _NO_BUNDLE.get(path.suffix.lower())) is not None:
            raise ReadError("file-unreadable", f"`{shown}` is {what}")
        else:
            files = _read_archive(path if content is None else BytesIO(content), shown)
        bundle = Bundle(files, _model(files, path, shown))
        texts = (content for name, content in files.items() if name.endswith(".xml"))
        if any(map(_EXPANDS.search, (files[bundle.model], *texts))):
            _check_size(bundle, path, shown)
        return bundle
    except BundleError as error:
        raise ReadError("file-unreadable", f"`{shown}` is not a bundle: {error}") from error
    except OSError as error:
        raise ReadError("file-unreadable", f"cannot read `{shown}`: {error.strerror or error}") from error


def _check_size(bundle: Bundle, path: Path, shown: str) -> None:
    found = Sink()
    text = bundle.files[bundle.model]
    parse_text(text, found, file=bundle.model, directory=path, label=path.stem, contents=bundle.files)
    for fault in found.errors:
        if fault.code == "limit-exceeded":
            raise ReadError(fault.code, f"`{shown}`: {fault.message}", fault.help, notes=(f"at {fault.span}",))


def _read_folder(folder: Path, shown: str) -> dict[str, bytes]:
    sizes: dict[str, int] = {}
    for parent, folders, names in os.walk(folder, onerror=raise_error):
        for name in [*folders, *names]:
            file = Path(parent) / name
            status = file.lstat()
            if stat.S_ISDIR(status.st_mode):
                continue
            path = file.relative_to(folder).as_posix()
            if not stat.S_ISREG(status.st_mode):
                kind = "a link" if stat.S_ISLNK(status.st_mode) else "no ordinary file"
                raise ReadError("file-unreadable", f"`{path}` in `{shown}` is {kind}")
            sizes[path] = status.st_size
            if len(sizes) > in_force().output_files:
                break
    _check_sizes(sizes, shown)
    files = {path: read_regular(folder / path) for path in sizes}
    if b"../assets/" not in files.get(MANIFEST, b""):
        return files
    from mjcompose.bundle.remote import with_shared_assets  # which needs a tree

    return with_shared_assets(files, folder)


def _read_archive(file: Path | BytesIO, shown: str) -> dict[str, bytes]:
    try:
        opened = file if isinstance(file, BytesIO) else open_regular(file, in_force().output_size)
        with opened as stream, zipfile.ZipFile(stream) as archive:
            entries = [entry for entry in archive.infolist() if not entry.filename.endswith("/")]
            _check_entries(entries, shown)
            return {entry.filename: archive.read(entry) for entry in entries}
    except (ReadError, BundleError):
        raise
    except ZIP_FAULTS as error:
        raise ReadError("file-unreadable", f"`{shown}` is not a readable zip: {error}") from error


def _check_entries(entries: list[zipfile.ZipInfo], shown: str) -> None:
    sizes: dict[str, int] = {}
    for entry in entries:
        path = entry.filename
        if path in sizes:
            raise ReadError("file-unreadable", f"`{shown}` has `{path}` twice")
        if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
            raise ReadError("file-unreadable", f"`{path}` in `{shown}` is a link or no ordinary file")
        if entry.flag_bits & 1:
            raise ReadError("file-unreadable", f"`{path}` in `{shown}` is encrypted")
        sizes[path] = entry.file_size
    _check_sizes(sizes, shown)
    check_paths(sizes)


def _check_sizes(sizes: dict[str, int], shown: str) -> None:
    limits = in_force()
    if len(sizes) > limits.output_files:
        raise ReadError("file-unreadable", f"`{shown}` has more than {limits.output_files} files")
    if sum(sizes.values()) > limits.output_size:
        raise ReadError("file-unreadable", f"`{shown}` holds more than {limits.output_size} bytes")


def _model(files: dict[str, bytes], path: Path, shown: str) -> str:
    for candidate in (named_model(files.get(MANIFEST, b"")), MODEL, f"{path.stem}.xml"):
        if candidate in files:
            return candidate
    texts = {path: content for path, content in files.items() if _ROOT.match(content)}
    references = [name.decode("utf-8", "replace") for content in texts.values() for name in _NAMED.findall(content)]
    named = set(map(posixpath.basename, references))
    models = sorted(path for path in texts if posixpath.basename(path) not in named)
    if len(models) == 1:
        return models[0]
    several = f", and several other models: {', '.join(f'`{each}`' for each in models)}" if models else ""
    raise ReadError("file-unreadable", f"`{shown}` has neither `{MODEL}` nor `{path.stem}.xml`{several}")


def named_model(manifest: bytes) -> str:
    """Return the model's path in the text of a manifest, or an empty text if there is none. No I/O."""
    try:
        named = json.loads(manifest)["model"]
    except (KeyError, TypeError, ValueError, RecursionError):
        return ""
    return named if isinstance(named, str) else ""
