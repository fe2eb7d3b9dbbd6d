"""The folders that the user's own model may see: those of its project."""

from __future__ import annotations

import os
from collections.abc import Iterable
from functools import cache

from composer.reading.door import Door
from composer.reading.folders import memory_of, real_folder

MARKERS = (".git", ".hg", "pyproject.toml", "package.xml", "mjcompose.lock")
"""Entries that mark the top folder of a project."""
_is_top = memory_of(MARKERS)
_HELP = "if it is meant, write in the recipe `trust: {files: [{folder}]}`"


def project_of(folder: str | os.PathLike[str]) -> str | None:
    """Return the nearest folder, this one or one above it, with a project marker, or None.

    Home folders and folders above them do not count: a `.git` there is for somebody's settings.
    """
    at, too_wide = os.path.abspath(folder), _too_wide(_home())
    while at not in too_wide:
        if _is_top(at):
            return at
        at = os.path.dirname(at)
    return None


def folders_of_model(path: str | os.PathLike[str]) -> list[str]:
    """Return the folders that a model file may see: its project, by its given and its real path.

    Without a project it is the folder above its own: 353 of 361 models of the corpus need no more, as in
    `robot/mjcf/arm.xml` and `robot/meshes/`; the other 8 are in repositories, and reach to their top. The folder
    above does not count if it is a home folder, the one for temporary files, or above one of these.
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
    """Return the door of the user's own model.

    `also` are more folders, `recipe` the folder of the recipe that names the model.
    """
    folders = folders_of_model(model)
    return Door.of(
        (*folders, *also),
        f"`{folders[0]}`, which is all that this model may read",
        None if recipe is None else _HELP,
        start=recipe,
    )


def _around(folder: str) -> str:
    known = project_of(folder)
    if known is not None:
        return known
    above = os.path.dirname(folder)
    return folder if above in _too_wide(_home()) else above


def _home() -> str:
    # `expanduser` takes as long as three calls of `stat`.
    return (os.environ.get("HOME") if os.name == "posix" else None) or os.path.expanduser("~")


@cache
def _too_wide(home: str) -> frozenset[str]:
    """Return folders that are too general: homes, the one for temporary files, and all folders above these."""
    import tempfile  # a model that the cache knows needs no folder of its own

    found: set[str] = set()
    for each in (home, tempfile.gettempdir()):
        for at in (os.path.abspath(each), os.path.realpath(each)):
            while at not in found:
                found.add(at)
                at = os.path.dirname(at)
    return frozenset(found)
