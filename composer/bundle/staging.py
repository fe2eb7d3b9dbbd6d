"""Write next to the target first, so that an output is either complete or absent."""

from __future__ import annotations

import contextlib
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.output_error import OutputError, unwritable
from composer.scratch import locked_folder, sweep_once

if TYPE_CHECKING:
    from collections.abc import Iterator

    from composer.bundle.bundle import Bundle


_OLD = "old-output"
_STAGE = re.compile(r"\.(.+)\.tmp-[0-9a-f]{12}", re.DOTALL)
"""The name of a stage's folder, which contains the name of its target."""


def sibling(target: Path, purpose: str) -> Path:
    """Return an unused path next to `target`, on the same file system."""
    return target.with_name(f".{target.name}.{purpose}-{os.urandom(6).hex()}")


@contextlib.contextmanager
def staged_file(out: Path) -> Iterator[Path]:
    """Yield a path to write to; when the block succeeds, the file moves to `out` in one step.

    Folders above `out` are created. After a failure nothing is left and an older `out` is untouched; errors of the
    file system become OutputError.
    """
    target = real(out)
    if os.path.isdir(target):
        raise OutputError(
            "output-unwritable",
            f"cannot write the file `{out}`: a folder of that name is there",
            "choose another name, or remove the folder",
        )
    try:
        with parents(target), stage_beside(target) as stage:
            yield stage
            stage.replace(target)
    except OSError as error:
        raise unwritable(out, error) from error


@contextlib.contextmanager
def stage_beside(target: Path) -> Iterator[Path]:
    """Yield a path that can be renamed to `target`, whose folder exists, in one step. Raises OSError.

    It is in a locked folder that is removed after the block. Leftovers of killed processes are removed as well.
    """
    sweep_once(target.parent, _is_stage, _put_back)
    with locked_folder(sibling(target, "tmp")) as folder:
        yield folder / "new-output"


def aside(stage: Path) -> Path:
    """Return where an older output is kept while the new one replaces it; after a kill it is restored from there."""
    return stage.with_name(_OLD)


def _is_stage(name: str) -> bool:
    return _STAGE.fullmatch(name) is not None


def _put_back(folder: Path) -> None:
    """Restore the older output if its process was killed before the new one replaced it."""
    found = _STAGE.fullmatch(folder.name)
    assert found is not None
    target = folder.with_name(found.group(1))
    if os.path.lexists(folder / _OLD) and not os.path.lexists(target):
        (folder / _OLD).replace(target)


@contextlib.contextmanager
def parents(target: Path) -> Iterator[None]:
    """Create the folders above `target` for the block, and remove them again if it fails."""
    made: list[Path] = []
    missing = [folder for folder in target.parents if not os.path.exists(folder)]
    try:
        for folder in reversed(missing):
            folder.mkdir(exist_ok=True)
            made.append(folder)
        yield
    except BaseException:
        for folder in reversed(made):
            with contextlib.suppress(OSError):
                folder.rmdir()
        raise


def real(out: Path) -> Path:
    """Return `out` as absolute path with links resolved: the target of a link is replaced, not the link."""
    return Path(os.path.realpath(out))


def write_files(bundle: Bundle, folder: Path) -> None:
    """Write the bundle's files below an existing, empty folder. Raises OSError."""
    made = {folder}
    for path, content in bundle.files.items():
        file = folder / path
        if file.parent not in made:
            file.parent.mkdir(parents=True, exist_ok=True)
            made.add(file.parent)
        with file.open("xb") as stream:
            stream.write(content)
