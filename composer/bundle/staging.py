"""The one writer: every output of every command is written next to its place, and then renamed.

So an output is either complete or absent, and an older one stays until then. It never takes the place of a file that
the run reads: a recipe, a model, an asset, a lock and what it pins, under any of its names.
"""

from __future__ import annotations

import contextlib
import os
import re
import stat
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.output_error import OutputError, unwritable
from composer.reading import sources
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
def staged_file(
    out: Path, option: str | None = None, *, inputs: Iterable[Path] = (), rewrites: bool = False
) -> Iterator[Path]:
    """Yield a path to write to; when the block succeeds, the file moves to `out` in one step.

    Folders above `out` are created. After a failure nothing is left and an older `out` is untouched; errors of the
    file system become OutputError. `option` names the output in messages, `inputs` are sources besides those that were
    noted. Only what `rewrites` a source, as `fmt` does, may take its place.
    """
    target = real(out)
    check_kind(target, out, option)
    if not rewrites:
        check_is_no_source(out, option, inputs)
    try:
        with parents(target), stage_beside(target) as stage:
            yield stage
            if not rewrites:
                check_is_no_source(out, option)  # it may have been read within the block
            stage.replace(target)
    except OSError as error:
        raise unwritable(out, error) from error
    sources.current().wrote(str(target))


@contextlib.contextmanager
def staged_folder(
    out: Path,
    option: str | None = None,
    *,
    inputs: Iterable[Path] = (),
    into: bool = False,
    replaces: bool = False,
) -> Iterator[Path]:
    """Yield a path for a folder that the block makes and that moves to `out`, as `staged_file` does.

    It `replaces` an older output, or takes the place of an empty folder. Or the block moves single files `into` the
    folder, with `move`.
    """
    target = real(out)
    if not target.name:
        raise OutputError("output-unwritable", f"`{out}` cannot be replaced", "choose a folder below it")
    if not into:
        check_is_no_source(out, option, inputs)
    try:
        with parents(target), stage_beside(target) as stage:
            yield stage
            if not into:
                check_is_no_source(out, option)
                (_swap if replaces else os.replace)(stage, target)
                sources.current().wrote(str(target))
    except OSError as error:
        raise unwritable(out, error) from error


def move(stage: Path, target: Path, paths: Iterable[str]) -> None:
    """Move files of a stage into the folder `target`, in this order; all of it at once if there is none."""
    paths = tuple(paths)
    for path in paths:
        check_is_no_source(target / path)
    if not os.path.exists(target):
        stage.replace(target)
        return
    for path in paths:
        (target / path).parent.mkdir(parents=True, exist_ok=True)
        (stage / path).replace(target / path)
        sources.current().wrote(str(target / path))


def check_is_no_source(out: Path, option: str | None = None, inputs: Iterable[Path] = ()) -> None:
    """Refuse an output that is a source of this run, or a folder with one in it. Raises OutputError.

    If that cannot be found out, for whatever reason, the output is refused.
    """
    written = f"`{option} {out}`" if option else f"`{out}`"
    try:
        source = sources.current().taken(str(out), more=inputs)
        is_inside = source is not None and os.path.isdir(out)
    except Exception as error:
        message = f"cannot write {written}: whether it is a source cannot be found out: {error or type(error).__name__}"
        raise OutputError("output-unwritable", message, "choose another output") from error
    if source is None:
        return
    what = f"{written} is one of the files that this model is built from"
    if is_inside:
        name = os.path.basename(source)
        what = f"the folder {written} holds files that this model is built from, such as `{name}`"
    raise OutputError("output-unwritable", what, "choose another output")


def check_kind(target: Path, out: Path, option: str | None = None) -> None:
    """Refuse a file where a folder, a pipe or a device is. Raises OutputError."""
    written = f"`{option} {out}`" if option else f"the file `{out}`"
    try:
        mode = os.stat(target).st_mode
    except (OSError, ValueError):
        return  # reported where it is written
    if stat.S_ISDIR(mode):
        what = f"cannot write {written}: a folder of that name is there"
        raise OutputError("output-unwritable", what, "choose another name, or remove the folder")
    if not stat.S_ISREG(mode):
        what = f"cannot write {written}: it is not an ordinary file"
        help = "choose the name of a file; where a command has standard output, it is `-`"
        raise OutputError("output-unwritable", what, help)


@contextlib.contextmanager
def stage_beside(target: Path) -> Iterator[Path]:
    """Yield a path that can be renamed to `target`, whose folder exists, in one step. Raises OSError.

    It is in a locked folder that is removed after the block. Leftovers of killed processes are removed as well.
    """
    sweep_once(target.parent, _is_stage, _put_back)
    with locked_folder(sibling(target, "tmp")) as folder:
        yield folder / "new-output"


def _swap(stage: Path, target: Path) -> None:
    """Move `stage` to `target`; if that fails, restore an earlier target."""
    if not os.path.exists(target):
        stage.replace(target)
        return
    older = aside(stage)
    target.replace(older)
    try:
        stage.replace(target)
    except BaseException:
        older.replace(target)
        raise


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
