"""The writer of every output of every command: it writes next to the final path and then renames.

So an output is either complete or absent, and an older one stays until then. It never replaces a file that the run
reads: a recipe, a model, an asset, a lock and its pinned files, under any name.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import stat
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base import files as sources
from mjcompose.base.access import ALL, Door
from mjcompose.base.files import CODE, read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.scratch import locked_folder, scratch, sweep_once
from mjcompose.bundle.bundle import (
    LARGEST_MANIFEST,
    MANIFEST,
    Bundle,
    OutputError,
    files_in,
    raise_error,
    to_text,
    writing,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from mjcompose.mujoco import engine

_OLD = "old-output"
_STAGE = re.compile(r"\.(.+)\.tmp-[0-9a-f]{12}", re.DOTALL)
"""The name of a stage's folder, which contains the name of its target."""


def sibling(target: Path, purpose: str) -> Path:
    """Return an unused path next to `target`, on the same file system."""
    return target.with_name(f".{target.name}.{purpose}-{os.urandom(6).hex()}")


@contextlib.contextmanager
def staged_file(
    out: Path,
    option: str | None = None,
    *,
    inputs: Iterable[str | Path] = (),
    rewrites: bool = False,
    within: Door = ALL,
) -> Iterator[Path]:
    """Yield a path to write to; when the block succeeds, the file moves to `out` in one step.

    Folders above `out` are created. After a failure nothing is left and an older `out` is untouched; errors of the file
    system become OutputError. `option` names the output in messages, and `inputs` are sources in addition to those that
    the run has read. Only output that `rewrites` a source, as `fmt` does, may replace it.

    Links are resolved once, so the file that `within` allows is the file that is replaced: a link that takes its place
    meanwhile is itself replaced, and not followed.
    """
    target = resolved_output(out)
    if not within.sees(target):
        refused = within.outside(str(out))
        raise OutputError(CODE, refused.message(), refused.help)
    check_kind(target, out, option)
    if not rewrites:
        check_is_no_source(out, option, inputs)
    with writing(out), created_parents(target), stage_beside(target) as stage:
        yield stage
        if not rewrites:
            check_is_no_source(out, option)  # it may have been read within the block
        stage.replace(target)
    sources.current().wrote(str(target))


class ChangedError(Exception):
    """A file no longer has the text that its edit is based on, so it is not changed."""


def replace_text(
    file: Path,
    text: bytes,
    option: str | None = None,
    *,
    before: bytes | None = None,
    allowed: Callable[[], object] | None = None,
    within: Door = ALL,
) -> None:
    """Replace a source in one step, or write the text to the path of `option`; keep the file's permissions.

    Raises OutputError, even for a file that is not `within` a door, and ChangedError if the file no longer has the text
    `before`. Once the new text is ready, `allowed` is called, and an error that it raises leaves the file as it is.
    """
    with staged_file(file, option, rewrites=option is None, within=within) as stage:
        stage.write_bytes(text)
        with contextlib.suppress(OSError):
            stage.chmod(stat.S_IMODE(os.stat(file).st_mode))
        if allowed is not None:
            allowed()
        if before is not None and read_regular(file, in_force().xml_size) != before:
            raise ChangedError


@contextlib.contextmanager
def staged_folder(
    out: Path, option: str | None = None, *, inputs: Iterable[Path] = (), into: bool = False, replaces: bool = False
) -> Iterator[Path]:
    """Yield a path, as `staged_file` does, for a folder that `replaces` another, or from which `move` takes files."""
    target = resolved_output(out)
    if not target.name:
        raise OutputError("output-unwritable", f"`{out}` cannot be replaced", "choose a folder below it")
    if not into:
        check_is_no_source(out, option, inputs)
    with writing(out), created_parents(target), stage_beside(target) as stage:
        yield stage
        if not into:
            check_is_no_source(out, option)
            (_swap if replaces else os.replace)(stage, target)
            sources.current().wrote(str(target))


def move(stage: Path, target: Path, paths: Iterable[str], inputs: Iterable[str | Path] = ()) -> None:
    """Move files of a stage into the folder `target`, in this order; all of it at once if there is none."""
    paths = tuple(paths)
    inputs = tuple(inputs)
    for path in paths:
        check_is_no_source(target / path, inputs=inputs)
    if not os.path.exists(target):
        stage.replace(target)
        return
    for path in paths:
        (target / path).parent.mkdir(parents=True, exist_ok=True)
        (stage / path).replace(target / path)
        sources.current().wrote(str(target / path))


def check_is_no_source(out: Path, option: str | None = None, inputs: Iterable[str | Path] = ()) -> None:
    """Refuse an output that is, contains or may be a source of this run. Raises OutputError."""
    written = f"`{option} {out}`" if option else f"`{out}`"
    try:
        source = sources.current().taken(str(out), more=inputs)
        is_inside = source is not None and os.path.isdir(out)
    except Exception as error:
        message = f"cannot write {written}, which may be a source of this run: {error or type(error).__name__}"
        raise OutputError("output-unwritable", message, "choose another output") from error
    if source is None:
        return
    message = f"{written} is one of the files that this model is built from"
    if is_inside:
        name = os.path.basename(source)
        message = f"the folder {written} holds files that this model is built from, such as `{name}`"
    raise OutputError("output-unwritable", message, "choose another output")


def check_kind(target: Path, out: Path, option: str | None = None) -> None:
    """Refuse a file that would replace a folder, a pipe or a device. Raises OutputError."""
    written = f"`{option} {out}`" if option else f"the file `{out}`"
    try:
        mode = os.stat(target).st_mode
    except (OSError, ValueError):
        return  # reported where it is written
    why = "a folder of that name is there"
    help = "choose another name, or remove the folder"
    if not stat.S_ISDIR(mode):
        why = "it is not an ordinary file"
        help = "choose the name of a file; a command that can write to standard output calls it `-`"
    if not stat.S_ISREG(mode):
        raise OutputError("output-unwritable", f"cannot write {written}: {why}", help)


def check_own_place(out: str | Path) -> None:
    """Refuse an output that the user does not name, if it is a link out of its folder. Raises OutputError.

    Its name comes from data, such as the name of a model, so somebody else may have put the link there.
    """
    place = Path(os.path.abspath(out))
    if place.is_symlink() and not Door.of([place.parent]).sees(place):
        message = f"`{out}` is a link to `{os.path.realpath(place)}`"
        raise OutputError("output-unwritable", message, "remove the link, or name another output")


@contextlib.contextmanager
def stage_beside(target: Path) -> Iterator[Path]:
    """Yield a path in a locked folder, to be renamed to `target`. Raises OSError.

    Leftovers of killed processes are removed. The folder is in that of `target`, because a rename is one step only
    within a file system.
    """
    sweep_once(target.parent, lambda name: _STAGE.fullmatch(name) is not None, _put_back)
    with locked_folder(sibling(target, "tmp")) as folder:
        yield folder / "new-output"


def _swap(stage: Path, target: Path) -> None:
    """Move `stage` to `target`; if that fails, restore an earlier target."""
    if not os.path.exists(target):
        stage.replace(target)
        return
    older = backup_path(stage)
    target.replace(older)
    try:
        stage.replace(target)
    except BaseException:
        older.replace(target)
        raise


def backup_path(stage: Path) -> Path:
    """Return where an older output is kept while the new one replaces it; after a kill it is restored from there."""
    return stage.with_name(_OLD)


def _put_back(folder: Path) -> None:
    """Restore the older output if its process was killed before the new one replaced it."""
    found = _STAGE.fullmatch(folder.name)
    assert found is not None
    target = folder.with_name(found.group(1))
    if os.path.lexists(folder / _OLD) and not os.path.lexists(target):
        (folder / _OLD).replace(target)


@contextlib.contextmanager
def created_parents(target: Path) -> Iterator[None]:
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


def resolved_output(out: Path) -> Path:
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


@contextlib.contextmanager
def in_scratch(bundle: Bundle) -> Iterator[Path]:
    """Yield a temporary folder with the bundle's files; errors of the file system become OutputError."""
    with writing(), scratch("bundle") as folder:
        write_files(bundle, folder)
        yield folder


# files that other programs leave in a folder
_LITTER = {"MUJOCO_LOG.TXT", ".DS_Store", "Thumbs.db", "desktop.ini"}


def write_folder(bundle: Bundle, out: Path) -> None:
    """Write the files into the folder `out`, if it is new, empty or only an earlier output. Raises OutputError."""
    check_is_no_source(out)
    with writing(out):
        _check_replaceable(resolved_output(out), out)
    with staged_folder(out, replaces=True) as stage:
        stage.mkdir()
        write_files(bundle, stage)


def _check_replaceable(target: Path, out: Path) -> None:
    if os.path.exists(target) and not os.path.isdir(target):
        message = f"cannot write the folder `{out}`: a file of that name is there"
        raise OutputError("output-unwritable", message, "choose another name, or remove the file")
    present = _files_in(target) if os.path.exists(target) else set()
    known = _own_files(target) if present else set()
    if known is None:
        message = f"the folder `{out}` is not empty and was not made by mjcompose"
        raise OutputError("output-unwritable", message, "choose a new or empty folder")
    foreign = sorted(path for path in present - known if path.rsplit("/", 1)[-1] not in _LITTER)
    if foreign:
        listed = ", ".join(f"`{path}`" for path in foreign[:3])
        more = f" and {len(foreign) - 3} more" if len(foreign) > 3 else ""
        message = f"replacing the folder `{out}` would delete files that mjcompose did not write: {listed}{more}"
        raise OutputError("output-unwritable", message, "move them elsewhere, or choose another folder")


def _files_in(folder: Path) -> set[str]:
    """Return all files and links below a folder as paths with forward slashes."""
    found: set[str] = set()
    for parent, folders, files in os.walk(folder, onerror=raise_error):
        links = [name for name in folders if (Path(parent) / name).is_symlink()]
        found.update((Path(parent) / name).relative_to(folder).as_posix() for name in [*files, *links])
    return found


def _own_files(folder: Path) -> set[str] | None:
    """Return the files in the manifest of an earlier output, including the manifest, or None without a manifest."""
    file = folder / MANIFEST
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError, RecursionError):
        if not file.is_symlink():
            text = read_regular(file, LARGEST_MANIFEST, is_source=False)
            manifest = json.loads(text)
            if isinstance(manifest["mjcompose"], str) and isinstance(manifest["manifest"], int):
                return files_in(text)
    return None


def write_mjb(bundle: Bundle, out: Path, *, session: engine.Session | None = None) -> None:
    """Compile the bundle into MuJoCo's binary form, for this version, and a manifest next to it. Raises OutputError."""
    from mjcompose.mujoco import engine

    with staged_file(out) as stage:
        stage.touch()  # fail now if the operating system does not allow writing there
        with in_scratch(bundle) as folder:
            compiled = engine.compile(folder, bundle.model, mjb=stage, session=session)
        if not compiled.ok:
            raise OutputError("output-unwritable", f"cannot write `{out}`: {compiled.error}")
        if MANIFEST in bundle.files:
            check_own_place(manifest_beside(out))
            with staged_file(manifest_beside(out)) as beside:
                content = stage.read_bytes()
                manifest = json.loads(bundle.files[MANIFEST])
                listed = {"path": out.name, "sha256": hashlib.sha256(content).hexdigest(), "size": len(content)}
                beside.write_bytes(to_text({**manifest, "model": out.name, "files": [listed]}))


def manifest_beside(out: Path) -> Path:
    """Return the path of a compiled model's manifest. No I/O.

    >>> manifest_beside(Path("build/arm.mjb")).as_posix()
    'build/arm.manifest.json'
    """
    return out.with_suffix(f".{MANIFEST}")


def with_version(out: str, version: str | None = None) -> str:
    """Replace `{mujoco}` in a compiled model's name by the version of MuJoCo; no other version reads the file.

    No I/O except for the installed version of MuJoCo, if no version is given.

    >>> with_version("build/arm-{mujoco}.mjb", "4.0.0"), with_version("build/arm.mjb", "4.0.0")
    ('build/arm-4.0.0.mjb', 'build/arm.mjb')
    """
    if "{mujoco}" not in out:
        return out
    if version is None:
        from importlib import metadata  # takes longer to import than a known model to be found

        version = metadata.version("mujoco")
    return out.replace("{mujoco}", version)
