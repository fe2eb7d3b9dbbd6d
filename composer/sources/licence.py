"""The licence files that go with a model file."""

from __future__ import annotations

import os
from pathlib import Path

from composer.sources.licence_name import licences_in

_LEVELS = 3


def find(model: Path, base: Path | None = None) -> tuple[Path, ...]:
    """The licence files in the folder nearest to `model` that has any: its own, or one of the three above it.

    All texts in a folder `LICENSES` there are such. The search leaves neither `base` nor a folder that holds
    `.git`, and ends below the folder where Python packages are installed. Empty when there are none. Reads folders
    only, no files.
    """
    folder = Path(os.path.realpath(model.parent))
    top = Path(os.path.realpath(base)) if base is not None else None
    for _ in range(_LEVELS + 1):
        if folder.name in ("site-packages", "dist-packages"):
            break
        if found := tuple(sorted(_in_folder(folder))):
            return found
        if folder in (top, folder.parent) or (folder / ".git").exists():
            break
        folder = folder.parent
    return ()


def _in_folder(folder: Path) -> list[Path]:
    try:
        return [path for name in licences_in(os.fspath(folder)) if (path := folder / name).is_file()]
    except OSError:
        return []
