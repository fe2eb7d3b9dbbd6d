"""Write a project into a folder: all files that do not exist yet, or nothing."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from composer.bundle.output_error import OutputError
from composer.bundle.staging import move, real, staged_folder
from composer.reading.regular import read_regular


def write_project(
    files: Mapping[str, bytes], needed: Collection[str], folder: Path, finish: Callable[[Path], object]
) -> tuple[list[str], list[str]]:
    """Write files below `folder`, which may exist; `finish` adds to them before they become visible.

    Return the paths of the written files, and of existing ones that are kept. Raises OutputError, also if a
    `needed` file exists with another content; exceptions of `finish` propagate.
    """
    with staged_folder(folder, into=True) as stage:
        for path, content in files.items():
            (stage / path).parent.mkdir(parents=True, exist_ok=True)
            (stage / path).write_bytes(content)
        finish(stage)
        made = sorted(path.relative_to(stage).as_posix() for path in stage.rglob("*") if os.path.isfile(path))
        kept = [path for path in made if _is_kept(folder / path, stage / path, folder, needed=path in needed)]
        written = [path for path in made if path not in kept]
        move(stage, real(folder), written)
        return written, kept


def _is_kept(place: Path, made: Path, folder: Path, needed: bool) -> bool:
    """Return whether a file exists already. Raises OutputError for anything that blocks the project."""
    above = place.parent
    while above != folder:
        if os.path.lexists(above) and not os.path.isdir(above):
            raise _in_the_way(above, "and no folder")
        above = above.parent
    if not os.path.lexists(place):
        return False
    if os.path.isdir(place):
        raise _in_the_way(place, "and a folder")
    if needed and (not os.path.exists(place) or read_regular(place) != read_regular(made)):
        raise _in_the_way(place, "with another content than the project needs")
    return True


def _in_the_way(path: Path, what: str) -> OutputError:
    return OutputError(
        "output-unwritable",
        f"`{path}` exists already, {what}: nothing is written",
        "choose another folder, or move it away",
    )
