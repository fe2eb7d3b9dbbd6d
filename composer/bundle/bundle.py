"""A finished model as plain data: files by path."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections.abc import Iterable, Mapping
from dataclasses import field
from types import MappingProxyType

from composer.dataclass import dataclass

MODEL = "model.xml"
MANIFEST = "manifest.json"
LARGEST_MANIFEST = 64 << 20
"""The bytes of a manifest that is read."""
DRAWS = "randomize.json"
WORLDS = "worlds.npz"
_DRIVE = re.compile(r"[A-Za-z]:")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


class BundleError(ValueError):
    """The files cannot be a bundle: a path leads out of it, or two paths are equal on some systems."""


@dataclass(frozen=True, slots=True)
class Bundle:
    """The model's MJCF and everything it needs, independent of its form on disk.

    `files` maps relative paths with forward slashes to bytes; it is sorted and read-only. `model` is the path of
    the MJCF. Raises BundleError for absolute paths, `..`, backslashes and paths that differ only in case, because a
    bundle must be readable on every system. Can be pickled.
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


def check_paths(paths: Iterable[str]) -> None:
    """Raise BundleError for the first path that is invalid or conflicts with an earlier one.

    >>> check_paths(["a/b.obj", "a/B.obj"])
    Traceback (most recent call last):
        ...
    composer.bundle.bundle.BundleError: `a/B.obj` and `a/b.obj` are one file where case does not count
    """
    files: dict[str, str] = {}
    folders: dict[str, str] = {}
    for path in paths:
        fault = _fault(path)
        if fault:
            raise BundleError(f"`{path}` cannot be a path in a bundle: {fault}")
        key = _folded(path)
        if key in files:
            raise BundleError(f"`{path}` and `{files[key]}` are one file where case does not count")
        if key in folders:
            raise BundleError(f"`{path}` is a file and, for `{folders[key]}`, a folder")
        files[key] = path
        parts = key.split("/")
        for depth in range(1, len(parts)):
            folder = "/".join(parts[:depth])
            if folder in files:
                raise BundleError(f"`{files[folder]}` is a file and, for `{path}`, a folder")
            folders.setdefault(folder, path)


def _fault(path: str) -> str | None:
    """Return why a path is not relative, plain and valid on every system; None if it is."""
    if path.startswith("/") or _DRIVE.match(path):
        return "it is absolute"
    if "\\" in path:
        return "it has a backslash"
    if _CONTROL.search(path):
        return "it has a control character"
    parts = path.split("/")
    if ".." in parts:
        return "it leads out of the bundle"
    if "" in parts or "." in parts:
        return "it has an empty segment"
    try:
        path.encode()
    except UnicodeEncodeError:
        return "it is not Unicode text"
    return None


def _folded(path: str) -> str:
    return unicodedata.normalize("NFC", unicodedata.normalize("NFC", path).casefold())
