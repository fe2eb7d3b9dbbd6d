"""The door through which a reader's files come: it knows which folders the reader may see.

Whoever follows a path that a model or a recipe names asks the door of the one that names it. A path is judged where it
really leads: symbolic links are followed first.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import NewType

from composer.reading.folders import files_among, parted, real_folder
from composer.reading.refused import OUTSIDE, Refused
from composer.reading.regular import is_irregular, read_regular

_NO_NAMES = ("", os.curdir, os.pardir)
Passed = NewType("Passed", str)
"""A path that passed a door."""


@dataclass(frozen=True, slots=True)
class Door:
    """The folders that a reader may see, and how messages speak of them.

    `roots` are real paths. `sees_all` is for text that the user writes, who may name any file. `whose` is how messages
    call what the reader may see; `help` says what to do about a file outside, with `{folder}` for the folder that it is
    in and `{absolute}` for its whole path. `start` is the folder that the path in `{folder}` counts from.

    >>> Door.of(["/srv/robots"]).sees("/srv/robots/../secret.obj")
    False
    """

    roots: tuple[str, ...] = ()
    whose: str = "what it came with"
    help: str | None = None
    start: str | None = None
    sees_all: bool = False
    _folders: dict[str, tuple[str, bool]] = field(default_factory=dict, compare=False, repr=False)

    @classmethod
    def of(
        cls,
        folders: list[str | os.PathLike[str]] | tuple[str | os.PathLike[str], ...],
        whose: str = "what it came with",
        help: str | None = None,
        start: str | None = None,
    ) -> Door:
        """A door to some folders, as they are called by anyone."""
        roots = dict.fromkeys(real_folder(os.fspath(each)) for each in folders)
        return cls(tuple(roots), whose, help, start)

    def wider(self, folders: tuple[str | os.PathLike[str], ...]) -> Door:
        """The same door with more folders behind it."""
        if not folders:
            return self
        roots = dict.fromkeys((*self.roots, *map(os.path.realpath, folders)))
        return replace(self, roots=tuple(roots), _folders={})

    def sees(self, path: str | os.PathLike[str]) -> bool:
        """Whether a path leads to a place that the reader may see, be there something or not."""
        text = os.fspath(path)
        return self.sees_all or self._leads_inside(text, _mode(text))

    def exists(self, path: str | os.PathLike[str]) -> bool:
        """Whether there is something that the reader may see."""
        return self.sees(path) and os.path.exists(path)

    def admit(self, path: str | os.PathLike[str]) -> Passed:
        """The path, which may now be followed. Raises Refused, also for a pipe and other special files."""
        text = os.fspath(path)
        mode = _mode(text)
        if not (self.sees_all or self._leads_inside(text, mode)):
            raise self.outside(text)
        if not stat.S_ISREG(mode) and (what := is_irregular(text)) is not None:
            raise Refused(text, what)
        return Passed(text)

    def admit_listed(self, paths: Iterable[str]) -> dict[str, Passed]:
        """Those of some paths that one look at each folder shows to be ordinary files; `admit` judges the others."""
        return {
            path: Passed(path)
            for folder, found in files_among(paths)
            if self.sees_all or self._is_inside(real_folder(folder))
            for path in found
        }

    def read(self, path: str | os.PathLike[str], most: int | None = None) -> bytes:
        """The bytes of a file. Raises Refused, and OSError as `read_regular` does."""
        return read_regular(self.admit(path), most)

    def outside(self, path: str) -> Refused:
        """The refusal of a path that the reader may not see."""
        real = os.path.realpath(path)
        help = self.help
        if help is not None:
            folder = os.path.dirname(real)
            shown = folder if self.start is None else _relative(folder, self.start)
            help = help.replace("{folder}", shown).replace("{absolute}", folder)
        return Refused(path, OUTSIDE.format(self.whose), help, real)

    def _leads_inside(self, path: str, mode: int) -> bool:
        """Whether a path with that mode leads to a place behind the door; each folder is followed once."""
        folder, name = parted(path)
        if name in _NO_NAMES or stat.S_ISLNK(mode):
            return self._is_inside(os.path.realpath(path))
        known = self._folders.get(folder)
        if known is None:
            real = real_folder(folder)
            known = self._folders[folder] = real, self._is_inside(real)
        real, is_inside = known
        return is_inside or self._is_inside(os.path.join(real, name))

    def _is_inside(self, real: str) -> bool:
        return any(
            real == root or real.startswith(root if root.endswith(os.sep) else root + os.sep)
            for root in self.roots
        )


def _mode(path: str) -> int:
    """The mode of what stands there, not of what a link leads to; 0 where there is nothing."""
    try:
        return os.lstat(path).st_mode
    except (OSError, ValueError):
        return 0


ALL = Door(sees_all=True)
"""For what the user writes: a recipe of one's own, an argument of the command."""
NOTHING = Door()
"""For what has all its files in memory."""


def held(path: str | os.PathLike[str]) -> Passed:
    """A path that passed a door before, as all do that a unit holds (`Unit.contents`)."""
    return Passed(os.fspath(path))


def _relative(folder: str, start: str) -> str:
    """As a recipe in `start` writes the folder."""
    try:
        relative = os.path.relpath(folder, os.path.realpath(start)).replace(os.sep, "/")
    except ValueError:  # on another drive
        return folder
    return folder if relative.count("..") > 4 else relative
