"""The files that a run reads: no output of the run takes the place of one of them.

Every reader notes its files here, and the one writer (`bundle/staging.py`) asks here. Paths are resolved when something
is written, and not before. A file that the run itself wrote does not count as a source.
"""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager

from composer.limits import in_force
from composer.reading.folders import real_path
from composer.scratch import is_scratch

_NAMES = re.compile(
    rb"""[^\s\0"'<>|{}\[\],;:#]+\.\w{2,5}|"[^"\n\0]+"|'[^'\n\0]+'|(?<=[:-] )[^\s"'{\[][^\n\0#]*"""
)
"""What may name a file in a recipe: a word with a suffix, a quoted text, the rest of a line."""
_FOLDERS = re.compile(rb"""(?:mesh|texture|asset)dir\s*=\s*["']([^"'\n\0]+)["']""")
_COMMENT = re.compile(rb"(?m)(?:^|(?<=[ \t]))#[^\n]*")
_FILES = re.compile(rb"""\bfile\w*\s*=\s*["']([^"'\n\0]+)["']""")
_RECIPES = (".yaml", ".yml")
_MODELS = (*_RECIPES, ".xml", ".urdf", ".xacro")
_NOWHERE = {errno.ENOENT, errno.ENOTDIR, errno.EACCES, errno.ENAMETOOLONG, errno.ELOOP}
Identity = tuple[int, int]
"""The device and the inode of a file, which are the same under each of its names."""


class Run:
    """The sources of one run."""

    def __init__(self) -> None:
        self._noted: dict[str, None] = {}
        self._resolved = 0
        self._paths: set[str] = set()
        self._files: dict[Identity, str] = {}
        self._above: dict[str, str] = {}
        self._named: dict[Identity, str] = {}
        self._unscanned: list[str] = []
        self._scanned: set[Identity] = set()
        self._written: set[str] = set()

    def note(self, paths: Iterable[str | os.PathLike[str]]) -> None:
        """Note files that are read."""
        for path in paths:
            text = os.fspath(path)
            if text not in self._noted and not is_scratch(text):
                self._noted[text] = None

    def noted(self) -> tuple[str, ...]:
        """Return all that was noted, for a process that makes a part of the run."""
        return tuple(self._noted)

    def wrote(self, path: str) -> None:
        """Note a file or a folder that the run has written."""
        self._written.add(os.path.realpath(path))

    def taken(self, target: str, *, more: Iterable[str | os.PathLike[str]] = ()) -> str | None:
        """Return the source whose place `target` would take, or that is in the folder `target`; None for a free place.

        `more` are sources whoever wrote them. Raises OSError and ValueError: then nobody knows, and nothing is written.
        """
        self._resolve()
        real = os.path.realpath(target)
        at, identity = os.path.normcase(real), _identity(real)
        for path in more:
            source = os.path.normcase(real_path(path))
            is_same = identity is not None and identity == _identity(source)
            if is_same or source == at or source.startswith(_folder(at)):
                return os.fspath(path)
        if real in self._written:
            return None
        if at in self._paths:
            return real
        if identity is not None and identity in self._files:
            return self._files[identity]
        if identity is None:
            return None
        named = self._all_named()
        if not os.path.isdir(real):
            return named.get(identity)
        inside = (
            source for above, source in self._above.items() if above == at or identity == _identity(above)
        )
        below = (path for path in named.values() if real_path(path).startswith(_folder(real)))
        return next(inside, None) or next(below, None)

    def _resolve(self) -> None:
        """Resolve what was noted since the last time."""
        for path in list(self._noted)[self._resolved :]:
            self._resolved += 1
            real = real_path(path)
            if any(each in self._written for each in _with_above(real)):
                continue
            self._paths.add(os.path.normcase(real))
            if (identity := _identity(real)) is not None:
                self._files[identity] = path
                if path.lower().endswith(_RECIPES):
                    self._unscanned.append(path)
            for above in _with_above(os.path.dirname(os.path.normcase(real))):
                if above in self._above:
                    break
                self._above[above] = path

    def _all_named(self) -> Mapping[Identity, str]:
        """Return the files that recipes name, and those that recipes and models name that are only named.

        A variant that is not chosen has sources, too.
        """
        while self._unscanned:
            path = self._unscanned[-1]  # until it is scanned
            own = _identity(path)
            is_recipe = path.lower().endswith(_RECIPES)
            text, folder = b"" if own is None or own in self._scanned else _text(path), os.path.dirname(path)
            folders = [folder, *(os.path.join(folder, os.fsdecode(each)) for each in _FOLDERS.findall(text))]
            names = dict.fromkeys(
                os.fsdecode(word.strip(b" \t\r\"'"))
                for word in (_NAMES if is_recipe else _FILES).findall(
                    _COMMENT.sub(b"", text) if is_recipe else text
                )
            )
            more = []
            for named in (os.path.join(each, name) for each in folders for name in names):
                found = _identity(named)
                if found is not None and found not in self._files and os.path.isfile(named):
                    self._named[found] = named
                    if named.lower().endswith(_MODELS):
                        more.append(named)
            if own is not None:
                self._scanned.add(own)
            self._unscanned[-1:] = more
        return self._named


class _NoRun(Run):
    """A program of somebody else, which reads and writes as it likes."""

    def note(self, paths: Iterable[str | os.PathLike[str]]) -> None:
        """Note nothing."""


_runs: list[Run] = [_NoRun()]


def current() -> Run:
    """Return the run of this process that began last."""
    return _runs[-1]


@contextmanager
def run() -> Iterator[Run]:
    """Begin a run for the block, which starts without sources."""
    _runs.append(Run())
    try:
        yield _runs[-1]
    finally:
        _runs.pop()


def _folder(path: str) -> str:
    return path.rstrip(os.sep) + os.sep


def _with_above(path: str) -> Iterator[str]:
    """Yield a path and the folders above it."""
    while True:
        yield path
        above = os.path.dirname(path)
        if above == path:
            return
        path = above


def _identity(path: str) -> Identity | None:
    """Return what a file is under each of its names; None if it does not exist. Raises OSError and ValueError."""
    try:
        found = os.stat(path)
    except OSError as error:
        if error.errno in _NOWHERE:
            return None
        raise
    return found.st_dev, found.st_ino


def _text(path: str) -> bytes:
    from composer.reading.regular import TooLarge, read_regular  # which notes what it reads

    try:
        return read_regular(path, in_force().xml_size, is_source=False) if os.path.isfile(path) else b""
    except TooLarge:  # which no run reads
        return b""
