"""The folders that the author of a path may see. A `Door` checks the real target, without symbolic links."""

from __future__ import annotations

import fnmatch
import os
import re
import stat
from collections.abc import Iterable, Iterator
from dataclasses import field, replace
from functools import cache
from typing import NewType

from mjcompose.base import files
from mjcompose.base.dataclass import Struct
from mjcompose.base.files import OUTSIDE, Refused, is_irregular, memory_of, parted, read_regular, real_folder

_NO_NAMES = ("", os.curdir, os.pardir)
_MAGIC = re.compile(r"[*?\[]")
MOST_LOOKS = 20_000
Passed = NewType("Passed", str)
"""A path that mjcompose may read."""


class Door(Struct):
    """The folders that a reader may see, and their wording in messages.

    `roots` are real paths. `sees_all` is for text from the user, who may name any file. `whose` describes the
    readable files in messages; `help` says what to do about a file outside, with `{folder}` for its folder and
    `{absolute}` for its whole path. The path in `{folder}` is relative to `start`.

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
        """Return a door to some folders, whose paths may contain links."""
        return cls(tuple(dict.fromkeys(real_folder(os.fspath(each)) for each in folders)), whose, help, start)

    def wider(self, folders: tuple[str | os.PathLike[str], ...]) -> Door:
        """Return the same door with more folders."""
        if not folders:
            return self
        return replace(self, roots=tuple(dict.fromkeys((*self.roots, *map(os.path.realpath, folders)))), _folders={})

    def sees(self, path: str | os.PathLike[str]) -> bool:
        """Return whether a path leads to a place that the reader may see, whether or not it exists."""
        text = os.fspath(path)
        return self.sees_all or self._is_seen(text, _mode(text))

    def exists(self, path: str | os.PathLike[str]) -> bool:
        """Return whether a path exists and may be seen."""
        return self.sees(path) and os.path.exists(path)

    def admit(self, path: str | os.PathLike[str]) -> Passed:
        """Return the path, which may now be opened. Raises Refused, even for pipes and other special files."""
        text = os.fspath(path)
        mode = _mode(text)
        if not (self.sees_all or self._is_seen(text, mode)):
            raise self.outside(text)
        if not stat.S_ISREG(mode) and (what := is_irregular(text)) is not None:
            raise Refused(text, what)
        files.current().note((text,))
        return Passed(text)

    def admit_listed(self, paths: Iterable[str]) -> dict[str, Passed]:
        """Return the paths that are ordinary files, by listing each folder. `admit` decides about the others."""
        passed = {
            path: Passed(path)
            for folder, found in files.files_among(paths)
            if self.sees_all or self._is_inside(real_folder(folder))
            for path in found
        }
        files.current().note(passed)
        return passed

    def read(self, path: str | os.PathLike[str], most: int | None = None) -> bytes:
        """Return the bytes of a file. Raises Refused, and OSError as `read_regular` does."""
        return read_regular(self.admit(path), most)

    def search(self, pattern: str, looks: Iterator[int] | None = None) -> list[str]:
        """Return the paths that match a pattern, sorted; `*` matches within one name. Raises Refused.

        It lists only folders that the reader may see. Each name costs one of the `looks`, which several searches may
        share.
        """
        looks = iter(range(MOST_LOOKS)) if looks is None else looks
        parts = pattern.split(os.sep)
        first = next((i for i, part in enumerate(parts) if _MAGIC.search(part)), len(parts))
        found = [os.sep.join(parts[:first]) or os.sep]
        for part in parts[first:]:
            folders = found
            found = []
            for folder in folders:
                if not self.sees(folder):
                    raise self.outside(folder)
                names = _names(folder) if _MAGIC.search(part) else [part]
                for name in names:
                    if next(looks, None) is None:
                        raise Refused(pattern, "fits too many files to look through")
                    path = os.path.join(folder, name)
                    if fnmatch.fnmatchcase(name, part) if _MAGIC.search(part) else os.path.lexists(path):
                        found.append(path)
        return sorted(found)

    def outside(self, path: str) -> Refused:
        """Return the refusal of a path that the reader may not see."""
        try:
            real = os.path.realpath(path)
        except Exception:  # it may be why the path is refused
            return Refused(path, OUTSIDE.format(self.whose), self.help and self.help.replace("{folder}", path))
        help = self.help
        if help is not None:
            folder = os.path.dirname(real)
            shown = folder if self.start is None else _relative(folder, self.start)
            help = help.replace("{folder}", shown).replace("{absolute}", folder)
        return Refused(path, OUTSIDE.format(self.whose), help, real=real)

    def _is_seen(self, path: str, mode: int) -> bool:
        try:
            return self._leads_inside(path, mode)
        except Exception:  # unknown means outside
            return False

    def _leads_inside(self, path: str, mode: int) -> bool:
        """Return whether a path with that mode leads inside; the links of each folder are resolved once."""
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
        return any(real == root or real.startswith(root.rstrip(os.sep) + os.sep) for root in self.roots)


def _names(folder: str) -> list[str]:
    try:
        return [name for name in os.listdir(folder) if not name.startswith(".")]
    except OSError:
        return []


def _mode(path: str) -> int:
    try:
        return os.lstat(path).st_mode
    except (OSError, ValueError):
        return 0


ALL = Door(sees_all=True)
"""For text from the user: a local recipe, or an argument of the command."""
SERVED = os.environ.get("MJCOMPOSE_SERVED")
"""The only folder of the user's that this process may see, for those who ask `mjcompose mcp`; None for any folder."""


def door_of_user() -> Door:
    """Return the door of the user's own recipes."""
    return ALL if SERVED is None else Door.of([SERVED], f"`{SERVED}`, the only folder that `mjcompose mcp` reads")


def door_of_named(file: str | os.PathLike[str]) -> Door:
    """Return the door of a command that changes a file that the user names, which may be a link, and its project."""
    if os.fspath(file).lower().endswith(files.RECIPES):
        folders = [folder_of_recipe(file), folder_of_recipe(os.path.realpath(file))]
    else:
        folders = folders_of_model(file)
    return Door.of([*folders, file], f"`{folders[0]}`")


def door_of_walk(folder: str | os.PathLike[str]) -> Door:
    """Return the door of a command that changes all models below a folder, which may itself be a link."""
    return Door.of([folder], f"`{os.fspath(folder)}`")


NOTHING = Door()
"""For readers whose files are all in memory."""


def held(path: str | os.PathLike[str]) -> Passed:
    """Return a path that passed a door before, such as those in `Unit.contents`."""
    return Passed(os.fspath(path))


def _relative(folder: str, start: str) -> str:
    try:
        relative = os.path.relpath(folder, os.path.realpath(start)).replace(os.sep, "/")
    except ValueError:  # on another drive
        return folder
    return folder if relative.count("..") > 4 else relative


MARKERS = (".git", ".hg", "pyproject.toml", "package.xml", "mjcompose.lock")
"""Entries that mark the top folder of a project."""
_is_top = memory_of(MARKERS)
_HELP = "to allow it, write in the recipe `trust: {files: [{folder}]}`"


def project_of(folder: str | os.PathLike[str]) -> str | None:
    """Return the nearest folder at or above this one with a project marker, below home folders, or None."""
    at = os.path.abspath(folder)
    too_wide = _too_wide(_home())
    while at not in too_wide:
        if _is_top(at):
            return at
        at = os.path.dirname(at)
    return None


def folders_of_model(path: str | os.PathLike[str]) -> list[str]:
    """Return the folders that a model file may see: its project, by its given and its real path.

    Without a project it is the folder above its own: 353 of 361 models of the corpus need no more, as in
    `robot/mjcf/arm.xml` and `robot/meshes/`; the other 8 are in repositories, and reach to their top. The folder
    above does not count if it is a home folder, the folder for temporary files, or above one of these.
    """
    called = os.path.abspath(path)
    folder = os.path.dirname(called)
    real = os.path.dirname(os.path.realpath(called)) if os.path.islink(called) else real_folder(folder)
    return list(dict.fromkeys(map(_around, dict.fromkeys((folder, real)))))


def folder_of_recipe(path: str | os.PathLike[str]) -> str:
    """Return the folder that the models of a recipe may see: its project, or without one its own folder."""
    own = os.path.dirname(os.path.abspath(path))
    return project_of(own) or own


def own_door(
    model: str | os.PathLike[str], also: Iterable[str | os.PathLike[str]] = (), recipe: str | None = None
) -> Door:
    """Return the door of the user's own model. `also` has more folders, and `recipe` is the folder of its recipe."""
    if SERVED is not None:
        also = ()
        served = door_of_user()
        if served.sees(model):
            return served
    folders = folders_of_model(model)
    whose = f"`{folders[0]}`, the only folder that this model may read"
    help = None if recipe is None else _HELP
    return Door.of((*folders, *also), whose, help, start=recipe)


def _around(folder: str) -> str:
    above = os.path.dirname(folder)
    return project_of(folder) or (folder if above in _too_wide(_home()) else above)


def _home() -> str:
    # `expanduser` takes as long as three calls of `stat`.
    return (os.environ.get("HOME") if os.name == "posix" else None) or os.path.expanduser("~")


@cache
def _too_wide(home: str) -> frozenset[str]:
    """Return folders that are too general: home folders, the folder for temporary files, and all folders above them."""
    import tempfile  # a model that the cache knows needs no folder of its own

    found: set[str] = set()
    for each in (home, tempfile.gettempdir()):
        for at in (os.path.abspath(each), os.path.realpath(each)):
            while at not in found:
                found.add(at)
                at = os.path.dirname(at)
    return frozenset(found)
