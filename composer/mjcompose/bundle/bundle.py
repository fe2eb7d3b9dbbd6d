"""A finished model as files by path, its form, its place, its names, its licenses, and the outcomes of its checks."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import struct
import time
import unicodedata
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from enum import StrEnum
from io import BytesIO
from os import PathLike, fspath
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, DiagnosticError, Severity, Span
from mjcompose.base.files import read_regular
from mjcompose.base.naming import file_name, portable_step
from mjcompose.sources.context import Context

if TYPE_CHECKING:
    from mjcompose.plan.plan import Plan


class OutputError(DiagnosticError):
    """An output cannot be written. The raising code has restored the previous state."""


_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}
_HELP = {
    **dict.fromkeys((errno.EACCES, errno.EPERM, errno.EROFS), "choose a place that you may write to"),
    **dict.fromkeys(_FULL, "make room on the disk, or choose another place"),
    errno.ENAMETOOLONG: "choose a shorter name",
}


def unwritable_error(out: str | PathLike[str], error: OSError) -> OutputError:
    """Return the operating system's error in the user's terms."""
    reason = error.strerror or str(error) or type(error).__name__
    return OutputError(
        "output-full" if error.errno in _FULL else "output-unwritable",
        f"cannot write `{out}`: {reason.lower()}",
        _HELP.get(error.errno or 0, "choose another place"),
    )


@contextmanager
def writing(out: str | PathLike[str] = "a temporary folder") -> Iterator[None]:
    """Turn errors of the operating system within the block into OutputErrors about `out`."""
    try:
        yield
    except OSError as error:
        raise unwritable_error(out, error) from error


Moment = tuple[int, int, int, int, int, int]
"""Year, month, day, hour, minute, second."""

_FIRST_SECOND = 315532800  # 1980-01-01, the first day a zip can hold
_LAST_SECOND = 4354819198  # 2107-12-31 23:59:58, the last


def moment_of(environment: Mapping[str, str]) -> Moment:
    """Return 1980-01-01, or SOURCE_DATE_EPOCH (seconds, UTC) limited to the dates of a zip. Raises OutputError.

    >>> moment_of({"SOURCE_DATE_EPOCH": "1700000000"})
    (2023, 11, 14, 22, 13, 20)
    """
    epoch = environment.get("SOURCE_DATE_EPOCH")
    seconds = _FIRST_SECOND
    if epoch:
        if not (epoch.isascii() and epoch.removeprefix("-").isdigit()):
            message = f"the variable `SOURCE_DATE_EPOCH` is `{epoch}`, which is not a whole number of seconds"
            raise OutputError("output-unwritable", message, "unset it, or give it the seconds since 1970-01-01")
        seconds = min(max(int(epoch[:20]), _FIRST_SECOND), _LAST_SECOND)
    moment = time.gmtime(seconds)
    return moment.tm_year, moment.tm_mon, moment.tm_mday, moment.tm_hour, moment.tm_min, moment.tm_sec


def with_moment(archive: bytes, moment: Moment) -> bytes:
    """Return a zip from another program with this timestamp on all its files, otherwise unchanged. No I/O."""
    year, month, day, hour, minute, second = moment
    stamp = struct.pack("<HH", hour << 11 | minute << 5 | second // 2, (year - 1980) << 9 | month << 5 | day)
    changed = bytearray(archive)
    with zipfile.ZipFile(BytesIO(archive)) as opened:
        at = opened.start_dir
        for info in opened.infolist():
            changed[info.header_offset + 10 : info.header_offset + 14] = stamp
            changed[at + 12 : at + 16] = stamp
            name, extra, comment = struct.unpack_from("<HHH", archive, at + 28)
            at += 46 + name + extra + comment
    return bytes(changed)


class OutputForm(StrEnum):
    FOLDER = "folder"
    ARCHIVE = "archive"
    TEXT = "text"
    MJB = "mjb"
    USD = "usd"
    SHARED = "folder with shared assets"


_SUFFIXES = {".zip": OutputForm.ARCHIVE, ".mjz": OutputForm.ARCHIVE, ".xml": OutputForm.TEXT, ".mjb": OutputForm.MJB}
_SUFFIXES |= dict.fromkeys((".usd", ".usda", ".usdc", ".usdz"), OutputForm.USD)


def form_of(out: str | PathLike[str]) -> OutputForm:
    """Return the form for an output's name. Raises OutputError.

    A name that ends in a slash or has no suffix is a folder, and so is an existing folder.

    >>> form_of("build/arm"), form_of("arm.mjz")
    (<OutputForm.FOLDER: 'folder'>, <OutputForm.ARCHIVE: 'archive'>)
    """
    name = fspath(out)
    path = Path(name)
    if not name:
        raise OutputError("output-kind", "the output has no name", "write where the model should go: `-o out/`")
    if name.endswith(("/", "\\")) or not path.suffix or os.path.isdir(path):
        return OutputForm.FOLDER
    form = _SUFFIXES.get(path.suffix.lower())
    if form is None:
        help = f"end it in `.mjz`, `.zip`, `.xml`, `.mjb` or `.usdz`, or write `{name}/` for a folder"
        raise OutputError("output-kind", f"no output is called `*{path.suffix}`: `{name}`", help)
    return form


Location: TypeAlias = Path | str
"""A path, or an address as text."""
_ADDRESS = re.compile(r"[a-z][a-z0-9+.-]+://")


def path_of_bundle(bundle: object) -> str:
    """Return the path of a bundle as a program gave it. Raises TypeError for anything else, such as a recipe."""
    if isinstance(bundle, str | PathLike):
        return fspath(bundle)
    message = f"a bundle is the path of an output of `mjcompose build`, got `{type(bundle).__name__}`"
    if isinstance(bundle, Mapping):
        message += "; a mapping has no bundle: write `mjcompose.dumps(recipe)` to a file, and build that"
    raise TypeError(message)


def is_address(text: object) -> bool:
    """Return whether a text is an address, not a path.

    >>> is_address("s3://bucket/a.zip"), is_address("build/a.zip"), is_address("c:/a.zip")
    (True, False, False)
    """
    return isinstance(text, str) and _ADDRESS.match(text) is not None


def location(folder: Path, out: str) -> Location:
    """Return the location of an output that a text names, relative to a folder.

    >>> location(Path("/home/me"), "a.zip").as_posix(), location(Path("/home/me"), "s3://bucket/a.zip")
    ('/home/me/a.zip', 's3://bucket/a.zip')
    """
    return out if is_address(out) else Path(os.path.abspath(folder / out))


def hash_of(name: str) -> str:
    """Return the model's folder among 256, which keeps each of them small: two digits of a hash of its name.

    >>> hash_of("cell-s0001"), hash_of("cell-s0002")
    ('b0', '46')
    """
    return hashlib.sha256(file_name(name).encode()).hexdigest()[:2]


def picture_of(name: str) -> str:
    """Return the name of a model's picture, which is next to its bundle.

    >>> picture_of("demo")
    'demo.png'
    """
    return f"{file_name(name)}.png"


MODEL = "model.xml"
MANIFEST = "manifest.json"
LARGEST_MANIFEST = 64 << 20
"""The bytes of a manifest that is read."""
DRAWS = "randomize.json"
WORLDS = "worlds.npz"
TERRAIN = "terrain.json"
_DRIVE = re.compile(r"[A-Za-z]:")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


class BundleError(ValueError):
    """The files cannot be a bundle: a path leads out of it, or two paths are equal on some systems."""


class Bundle(Struct):
    """The model's MJCF and everything it needs, independent of its form on disk.

    `files` maps relative paths with forward slashes to bytes; it is sorted and read-only. `model` is the path of the
    MJCF. Raises BundleError for paths that are not valid and different on every system. Can be pickled.
    """

    files: Mapping[str, bytes]
    model: str = MODEL
    _digests: dict[str, str] = field(default_factory=dict, init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_paths(self.files)
        if self.model not in self.files:
            raise BundleError(f"the bundle has no `{self.model}`")
        object.__setattr__(self, "files", MappingProxyType(dict(sorted(self.files.items()))))

    def __reduce__(self) -> tuple[type[Bundle], tuple[dict[str, bytes], str]]:
        return Bundle, (dict(self.files), self.model)

    def with_files(self, files: Mapping[str, bytes]) -> Bundle:
        """Return the same bundle with these files added or replaced."""
        made = Bundle({**self.files, **files}, self.model)
        made._digests.update((path, known) for path, known in self._digests.items() if path not in files)
        return made

    def digest(self, path: str) -> str:
        """Return the sha256 of one file, in hexadecimal."""
        if path not in self._digests:
            self._digests[path] = hashlib.sha256(self.files[path]).hexdigest()
        return self._digests[path]

    @property
    def sha256(self) -> str:
        """The identity of the bundle: a hash of all paths and contents, independent of its form."""
        whole = hashlib.sha256()
        for path in self.files:
            whole.update(f"{path}\0{self.digest(path)}\n".encode())
        return whole.hexdigest()


def raise_error(error: OSError) -> None:
    """Raise an error of `os.walk`, which ignores it by default."""
    raise error


def to_text(data: object) -> bytes:
    """Return the bytes of a JSON file in a bundle: indented by two spaces, with a final newline."""
    return (json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode()


def files_in(manifest: bytes) -> set[str] | None:
    """Return the files that a manifest lists, including the manifest; None for any other text."""
    try:
        return {MANIFEST, *(str(each["path"]) for each in json.loads(manifest)["files"])}
    except (ValueError, KeyError, TypeError, RecursionError):
        return None


def check_paths(paths: Iterable[str]) -> None:
    """Raise BundleError for the first path that is invalid or conflicts with an earlier one.

    >>> check_paths(["a/b.obj", "a/B.obj"])
    Traceback (most recent call last):
        ...
    mjcompose.bundle.bundle.BundleError: `a/B.obj` and `a/b.obj` are the same file on systems that ignore case
    """
    files: dict[str, str] = {}
    folders: dict[str, str] = {}
    for path in paths:
        fault = path_fault(path)
        if fault:
            raise BundleError(f"`{path}` cannot be a path in a bundle: {fault}")
        key = unicodedata.normalize("NFC", unicodedata.normalize("NFC", path).casefold())
        if key in files:
            raise BundleError(f"`{path}` and `{files[key]}` are the same file on systems that ignore case")
        if key in folders:
            raise BundleError(f"`{path}` is a file, but `{folders[key]}` needs a folder of this name")
        files[key] = path
        parts = key.split("/")
        for depth in range(1, len(parts)):
            folder = "/".join(parts[:depth])
            if folder in files:
                raise BundleError(f"`{files[folder]}` is a file, but `{path}` needs a folder of this name")
            folders.setdefault(folder, path)


def path_fault(path: str) -> str | None:
    """Return why a path is not relative and plain, or leads out of its bundle; None if it is fine."""
    parts = path.split("/")
    if path.startswith("/") or _DRIVE.match(path):
        return "it is absolute"
    if "\\" in path:
        return "it has a backslash"
    if _CONTROL.search(path):
        return "it has a control character"
    if ".." in parts:
        return "it leads out of the bundle"
    if "" in parts or "." in parts:
        return "it has an empty segment"
    if path.encode("utf-8", "replace").decode() != path:
        return "it is not Unicode text"
    return None


LICENSES = "LICENSES"
_UNSAFE = re.compile(r"[^\w.+@=-]+")


class Licenses(Struct):
    """The license files of a bundle: `files` has their contents by path, and `of` has their paths by label."""

    files: Mapping[str, bytes]
    of: Mapping[str, tuple[str, ...]]


def license_files(licenses: Mapping[str, Iterable[Path]], read: Callable[[Path], bytes] = read_regular) -> Licenses:
    """Return every license file once, as `LICENSES/LABEL/FILE NAME`.

    `licenses` maps a label (a part's prefix such as `left/gripper`, or a source) to its license files. Equal files with
    the same name go under the first label; different files of one label are numbered. Raises OSError.
    """
    files: dict[str, bytes] = {}
    of: dict[str, tuple[str, ...]] = {}
    placed: dict[tuple[str, bytes], str] = {}
    known: dict[Path, bytes] = {}
    for label, sources in sorted(licenses.items()):
        paths: dict[str, None] = {}
        for file in sorted(sources):
            if file not in known:
                known[file] = read(file)
            name = _segment(file.name)
            content = known[file]
            if (name, content) not in placed:
                path = f"{license_folder(label)}/{name}"
                number = 1
                stem = path.removesuffix(file.suffix)
                while path.casefold() in map(str.casefold, files):
                    number += 1
                    path = f"{stem}-{number}{file.suffix}"
                placed[name, content] = path
                files[path] = content
            paths[placed[name, content]] = None
        of[label] = tuple(paths)
    return Licenses(files, of)


def license_folder(label: str) -> str:
    """Return the folder in the bundle for the licenses of a label.

    >>> license_folder("left/gripper")
    'LICENSES/left/gripper'
    """
    parts = [_segment(part) for part in re.split(r"[/\\]", label) if part]
    return "/".join([LICENSES, *(parts or ["model"])])


def _segment(name: str) -> str:
    """Return a name as a path segment that is valid on every file system."""
    return portable_step(_UNSAFE.sub("_", name).strip(".") or "_")


class CheckOutcome(Struct):
    """A check that ran: its name in the outermost recipe (`left/reach`), kind, place, diagnostics and values."""

    name: str
    kind: str
    span: Span
    diagnostics: tuple[Diagnostic, ...]
    values: Mapping[str, Any] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        return not any(each.severity is Severity.ERROR for each in self.diagnostics)


class LicenseRow(Struct):
    """One part: its model reference, its license as an SPDX expression (None if unknown), and its license files."""

    part: str
    source: str
    license: str | None
    files: tuple[str, ...]

    @property
    def has_none(self) -> bool:
        """Whether nothing states the license; an unrecognized license text counts as a statement."""
        return self.license is None and not self.files


def license_rows(plan: Plan, context: Context) -> list[LicenseRow]:
    """Return a row for each part, with the base named after its file. Reads license files and the heads of models."""
    from mjcompose.bundle.assemble import sources  # a model from the cache needs none of this
    from mjcompose.sources.license import is_empty, license_of

    rows = []
    for label, source in sources(plan):
        files = tuple(context.shown(file) for file in source.licenses if not is_empty(file))
        rows.append(LicenseRow(label, source.reference, license_of(source), files=files))
    return rows


def license_table(rows: Iterable[LicenseRow]) -> list[str]:
    """Return the lines of a table of licenses."""
    from mjcompose.sources.license import UNKNOWN

    lines = [("part", "source", "license", "file")]
    lines += [(row.part, row.source, row.license or UNKNOWN, ", ".join(row.files) or "-") for row in rows]
    widths = [max(len(line[column]) for line in lines) for column in range(3)]
    padded = ([*map(str.ljust, line[:3], widths), line[3]] for line in lines)
    return list(map("  ".join, padded))


def report_unlicensed(rows: Iterable[LicenseRow], context: Context) -> None:
    bare = [row for row in rows if row.has_none]
    if not bare:
        return
    names = ", ".join(f"`{row.part}`" for row in bare[:20])
    names += f" and {len(bare) - 20} other parts" if len(bare) > 20 else ""
    comment = "`<!-- SPDX-License-Identifier: CC-BY-4.0 -->`"
    help = f"put a `LICENSE` with its text next to the model, or {comment} at its top"
    context.sink.warning("license-missing", f"nothing says under which license {names} may be passed on", help=help)
