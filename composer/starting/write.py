"""Put a project where there is nothing of it yet: all of it, or nothing."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Mapping
from pathlib import Path

from composer.bundle.output_error import OutputError, unwritable
from composer.bundle.staging import parents, real, sibling


def write_project(files: Mapping[str, str], folder: Path, finish: Callable[[Path], object]) -> None:
    """Write files below `folder`, which may exist; `finish` adds to them before anything is seen there.

    Raises OutputError, also where one of the files is there already; what `finish` raises goes through.
    """
    for path in files:
        if os.path.lexists(folder / path):
            raise OutputError(
                "output-unwritable",
                f"`{folder / path}` is there already and nothing is written",
                "choose another folder, or move the file away",
            )
    target = real(folder)
    stage = sibling(target, "tmp")
    try:
        with parents(target):
            try:
                for path, text in files.items():
                    (stage / path).parent.mkdir(parents=True, exist_ok=True)
                    (stage / path).write_text(text, encoding="utf-8", newline="\n")
                finish(stage)
                _move(stage, target)
            finally:
                shutil.rmtree(stage, ignore_errors=True)
    except OSError as error:
        raise unwritable(folder, error) from error


def _move(stage: Path, target: Path) -> None:
    if not target.exists():
        stage.rename(target)
        return
    for file in sorted(path for path in stage.rglob("*") if path.is_file()):
        place = target / file.relative_to(stage)
        place.parent.mkdir(parents=True, exist_ok=True)
        file.rename(place)
