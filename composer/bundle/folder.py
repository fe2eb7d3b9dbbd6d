"""A bundle as a folder."""

from __future__ import annotations

import contextlib
import json
import os
from collections.abc import Iterable
from pathlib import Path

from composer.bundle.bundle import LARGEST_MANIFEST, MANIFEST, Bundle
from composer.bundle.output_error import OutputError, unwritable
from composer.bundle.staging import check_is_no_source, real, staged_folder, write_files
from composer.reading.regular import read_regular

# files that other programs leave in a folder
_LITTER = {"MUJOCO_LOG.TXT", ".DS_Store", "Thumbs.db", "desktop.ini"}


def write_folder(
    bundle: Bundle, out: Path, option: str | None = None, *, inputs: Iterable[Path] = ()
) -> None:
    """Write the bundle's files into the folder `out`, which then holds nothing else.

    The folder is built next to `out` and renamed. An existing folder is replaced only if it is empty or an earlier
    output without other files in it. Raises OutputError, and then leaves `out` as it was.
    """
    inputs = tuple(inputs)
    check_is_no_source(out, option, inputs)
    try:
        _check_replaceable(real(out), out)
    except OSError as error:
        raise unwritable(out, error) from error
    with staged_folder(out, option, inputs=inputs, replaces=True) as stage:
        stage.mkdir()
        write_files(bundle, stage)


def _check_replaceable(target: Path, out: Path) -> None:
    if not os.path.exists(target):
        return
    if not os.path.isdir(target):
        raise OutputError(
            "output-unwritable",
            f"cannot write the folder `{out}`: a file of that name is there",
            "choose another name, or remove the file",
        )
    present = _files_in(target)
    if not present:
        return
    known = _own_files(target)
    if known is None:
        raise OutputError(
            "output-unwritable",
            f"the folder `{out}` is not empty and was not made by mjcompose",
            "choose a new or empty folder",
        )
    foreign = sorted(path for path in present - known if path.rsplit("/", 1)[-1] not in _LITTER)
    if foreign:
        listed = ", ".join(f"`{path}`" for path in foreign[:3])
        more = f" and {len(foreign) - 3} more" if len(foreign) > 3 else ""
        raise OutputError(
            "output-unwritable",
            f"replacing the folder `{out}` would delete files that mjcompose did not write: {listed}{more}",
            "move them elsewhere, or choose another folder",
        )


def _files_in(folder: Path) -> set[str]:
    """Return all files and links below a folder as paths with forward slashes."""
    found: set[str] = set()
    for parent, folders, files in os.walk(folder, onerror=_raise):
        links = [name for name in folders if (Path(parent) / name).is_symlink()]
        found.update((Path(parent) / name).relative_to(folder).as_posix() for name in [*files, *links])
    return found


def _own_files(folder: Path) -> set[str] | None:
    """Return the files in the manifest of an earlier output, including the manifest, or None without a manifest."""
    file = folder / MANIFEST
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError, RecursionError):
        if file.is_symlink():
            return None
        manifest = json.loads(read_regular(file, LARGEST_MANIFEST, is_source=False))
        if isinstance(manifest["mjcompose"], str) and isinstance(manifest["manifest"], int):
            return {MANIFEST, *(str(entry["path"]) for entry in manifest["files"])}
    return None


def _raise(error: OSError) -> None:
    raise error
