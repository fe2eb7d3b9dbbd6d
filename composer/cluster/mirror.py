"""A mirror of a run's files on another machine: below a folder of its own, under the paths that they have here."""

from __future__ import annotations

import contextlib
import os
import pickle
import shutil
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields, is_dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Any

from composer.dataclass import dataclass
from composer.reading.project import MARKERS
from composer.sources.digest import sha256_of

_MOST_LINKS = 40


@dataclass(frozen=True, slots=True)
class Layout:
    """The contents of a mirror: real paths of files with their sha256, links with their targets, and folders."""

    files: Mapping[str, str]
    links: Mapping[str, str]
    folders: frozenset[str]


def layout_of(paths: Iterable[str]) -> Layout:
    """Return everything that makes the existing ones of these paths lead to the same files in a mirror.

    It includes the marker files that make a folder above them the top of a project, which limits what a model may
    read.
    """
    files: dict[str, str] = {}
    links: dict[str, str] = {}
    folders: set[str] = set()
    marked: set[str] = set()

    def add_file(real: str) -> None:
        if os.path.isfile(real) and real not in files:
            with contextlib.suppress(OSError):  # unreadable files are reported where they are needed
                files[real] = sha256_of(Path(real))

    def add(path: str) -> None:
        real = _followed(path, links)
        if os.path.isdir(real):
            folders.add(real)
        else:
            add_file(real)
        for start in (os.path.dirname(path), os.path.dirname(real)):
            at = start
            while at not in marked:
                marked.add(at)
                for name in MARKERS:
                    marker = os.path.join(at, name)
                    if os.path.isdir(marker):
                        folders.add(_followed(marker, links))
                    elif os.path.isfile(marker):
                        add_file(_followed(marker, links))
                at = os.path.dirname(at)

    for each in paths:
        add(os.path.abspath(each))
    return Layout(files, links, frozenset(folders))


def lay_out(layout: Layout, root: Path, content: Callable[[str], Path]) -> None:
    """Create the mirror below an empty folder; `content` returns the file with a sha256. Raises OSError."""
    for folder in layout.folders:
        _inside(root, folder).mkdir(parents=True, exist_ok=True)
    for path, digest in layout.files.items():
        target = _inside(root, path)
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(content(digest), target)
        except OSError:  # another file system, or one without links
            shutil.copyfile(content(digest), target)
    for path, leads in layout.links.items():
        link = _inside(root, path)
        link.parent.mkdir(parents=True, exist_ok=True)
        _inside(root, leads).parent.mkdir(parents=True, exist_ok=True)
        if not os.path.lexists(link):
            link.symlink_to(_inside(root, leads))


def loaded(content: bytes, root: str) -> Any:
    """Unpickle data with its absolute paths moved below `root`."""

    class Loader(pickle.Unpickler):
        def find_class(self, module: str, name: str) -> Any:
            found = super().find_class(module, name)
            if isinstance(found, type) and issubclass(found, Path):
                return lambda *parts: rooted(Path(*parts), root)
            return found

    return Loader(BytesIO(content)).load()


def rooted(path: Path, root: str) -> Path:
    """Return an absolute path moved below `root`, or a relative path as it is.

    >>> rooted(Path("a.xml"), "/r").as_posix(), rooted(Path("/home/a.xml"), "/r").as_posix()
    ('a.xml', '/r/home/a.xml')
    """
    return _inside(Path(root), str(path)) if path.is_absolute() else path


def without_root(value: Any, root: str) -> Any:
    """Return data with paths and texts as if the mirror were at the root of the machine.

    >>> without_root(("at /r/x/a.xml:3", Path("/r/x/b")), "/r/x")
    ('at /a.xml:3', PosixPath('/b'))
    """
    if isinstance(value, str):
        return value.replace(root, "")
    if isinstance(value, Path):
        return Path(str(value).replace(root, ""))
    if isinstance(value, Mapping):
        return {without_root(name, root): without_root(each, root) for name, each in value.items()}
    if isinstance(value, tuple | list | frozenset | set):
        return type(value)(without_root(each, root) for each in value)
    if is_dataclass(value) and not isinstance(value, type):
        changed = {}
        for each in fields(value):
            before = getattr(value, each.name)
            if each.init and (after := without_root(before, root)) != before:
                changed[each.name] = after
        return replace(value, **changed) if changed else value
    return value


def _inside(root: Path, path: str) -> Path:
    return root / os.path.relpath(path, os.path.abspath(os.sep))


def _followed(path: str, links: dict[str, str]) -> str:
    """Return the real path, and add each link on the way."""
    rest, at, followed = path.split(os.sep)[1:], os.sep, 0
    while rest:
        candidate = os.path.join(at, rest.pop(0))
        if os.path.islink(candidate) and followed < _MOST_LINKS:
            followed += 1
            leads = os.path.normpath(os.path.join(at, os.readlink(candidate)))
            links[candidate] = leads
            rest, at = [*leads.split(os.sep)[1:], *rest], os.sep
        else:
            at = candidate
    return at
