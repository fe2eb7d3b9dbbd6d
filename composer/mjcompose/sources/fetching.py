"""The rules for fetching in a run, the fetched sources, and the existing model files."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path, PurePath, PurePosixPath, PureWindowsPath
from typing import TYPE_CHECKING

from mjcompose.base.access import SERVED, Door, door_of_user, folder_of_recipe, own_door
from mjcompose.base.dataclass import Struct
from mjcompose.base.files import foreign_format, real_path
from mjcompose.base.suggest import closest, exists_note
from mjcompose.sources import license
from mjcompose.sources.blobs import sha256_of
from mjcompose.sources.reference import Origin, Reference, Source, SourceError, Trust, has_format, is_mesh

if TYPE_CHECKING:
    from mjcompose.sources.lock import Lock

DEFAULT = 30.0
_SHORTEST = 0.1
_LONGEST = 24 * 3600.0


def patience(environment: Mapping[str, str]) -> float:
    """Return the timeout in seconds from `MJCOMPOSE_TIMEOUT`. Raises SourceError for an invalid value."""
    written = environment.get("MJCOMPOSE_TIMEOUT", "")
    if not written:
        return DEFAULT
    try:
        seconds = float(written)
    except ValueError:
        seconds = 0.0
    if not _SHORTEST <= seconds <= _LONGEST:
        message = f"`MJCOMPOSE_TIMEOUT` is not a number of seconds from {_SHORTEST} to {_LONGEST:.0f}: `{written}`"
        raise SourceError("source-fetch", message, help="write it as `30`")
    return seconds


class Silence:
    """Measures the total silence of another machine over all attempts; `seconds` is the limit."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._since = time.monotonic()

    @property
    def left(self) -> float:
        """Remaining seconds; never zero, because a time limit of zero has another meaning."""
        return max(self._seconds - (time.monotonic() - self._since), 0.01)

    @property
    def is_nearly_over(self) -> bool:
        """Whether too little time is left for another attempt."""
        return self.left < self._seconds / 4

    @property
    def is_over(self) -> bool:
        return time.monotonic() - self._since >= self._seconds

    def broken(self) -> None:
        """Restart the measurement after the machine has answered."""
        self._since = time.monotonic()


_FIRST = 2.0
_EVERY = 1.0


@contextmanager
def waiting(progress: Callable[[str], None], what: str) -> Iterator[None]:
    """Report the duration of the block every second, from the second one on."""
    done = threading.Event()
    begun = time.monotonic()

    def report() -> None:
        pause = _FIRST
        while not done.wait(pause):
            progress(f"waiting {what}: {time.monotonic() - begun:.0f} s")
            pause = _EVERY

    reporter = threading.Thread(target=report, daemon=True)
    reporter.start()
    try:
        yield
    finally:
        done.set()
        reporter.join()


def quiet(message: str) -> None:
    """Discard progress messages."""


class Fetching(Struct, frozen=False):
    """The rules and the memory of one run.

    `offline`: nothing is fetched, and a source that is not in the store is an error. `locked`: a source that the lock
    does not pin is an error. `remakes_shapes`: the lock is being made, and need not have the shapes of meshes. `lock`
    is the lock of the recipe, `lock_file` is its path, even if it does not exist, and `recipe` is the recipe's name in
    messages. `fresh` are the origins whose pin is ignored, or None for all origins. `origins` are the origins resolved
    in this run, by id: all parts see the same commit of a moving branch. `first` has the first file requested from
    each. `digests` has the sha256 of files, and `files` has the files of sources; both are computed once for all cells
    of a matrix. `outer` is the outermost recipe, `trust` is its `trust`, and `doors` has the doors of models.
    `listings` has the model files of folders, for messages about files that do not exist.
    """

    offline: bool = False
    locked: bool = False
    remakes_shapes: bool = False
    lock: Lock | None = None
    lock_file: Path | None = None
    recipe: str = "RECIPE"
    fresh: frozenset[str] | None = frozenset()
    progress: Callable[[str], None] = quiet
    origins: dict[str, Origin] = field(default_factory=dict)
    first: dict[str, Source] = field(default_factory=dict)
    digests: dict[Path, str] = field(default_factory=dict)
    files: dict[Source, list[Path]] = field(default_factory=dict)
    outer: Path | None = None
    trust: Trust = field(default_factory=Trust)
    doors: dict[tuple[Path, Path | None, Trust], Door] = field(default_factory=dict)
    listings: dict[tuple[Path, int, bool], list[str]] = field(default_factory=dict)

    def model_files(self, folder: Path, depth: int | None = None, meshes: bool = False) -> list[str]:
        """Return `model_files` of a folder, which is searched once in a run."""
        key = (folder, _DEPTH if depth is None else depth, meshes)
        if key not in self.listings:
            self.listings[key] = model_files(*key)
        return self.listings[key]

    def digest(self, path: Path) -> str:
        """Return the sha256 of a file, which is read once. Raises OSError."""
        if path not in self.digests:
            self.digests[path] = sha256_of(path)
        return self.digests[path]

    def forget(self) -> None:
        """Forget the fetched sources, because one is damaged."""
        for memory in (self.origins, self.first, self.digests, self.files, self.doors):
            memory.clear()

    def around(self, path: Path) -> Origin | None:
        """Return the origin that a file or folder belongs to; the innermost if origins are nested."""
        if not self.origins:
            return None
        real = Path(real_path(path))
        found = [each for each in self.origins.values() if real.is_relative_to(real_path(each.root))]
        return max(found, key=lambda each: len(real_path(each.root)), default=None)

    def door_of_text(self, folder: Path) -> Door:
        """Return the door of a recipe in a folder, which admits all files, or only the files of its origin."""
        origin = self.around(folder)
        return door_of_user() if origin is None else self.door_of_origin(origin)

    def door_of_origin(self, origin: Origin) -> Door:
        """Return the door of files of an origin, which admits all files of the origin."""
        verb = "fetched" if origin.is_fetched else "installed"
        return Door.of(
            (origin.root, *(self.trust.folders if SERVED is None else ())),
            f"`{origin.id}`, which may read only files that were {verb} with it",
            "a fetched source must contain all files that it names; if you trust it, write in your own recipe"
            ' `trust: {references: ["{absolute}"]}`',
        )

    def door_of_model(self, path: Path) -> Door:
        """Return the door of the model at a path, which admits its project, the recipe's, and trusted folders."""
        key = path, self.outer, self.trust
        if key not in self.doors:
            start = None if self.outer is None else os.path.dirname(os.path.abspath(self.outer))
            recipe = () if self.outer is None else (folder_of_recipe(self.outer),)
            self.doors[key] = own_door(path, (*recipe, *self.trust.files), start)
        return self.doors[key]

    def pin(self, id: str) -> str | None:
        """Return the commit or sha256 that the lock has for an origin."""
        if self.lock is None or self.fresh is None or id in self.fresh or id not in self.lock.sources:
            return None
        return self.lock.sources[id].pin

    def known_files(self, id: str) -> Mapping[str, str]:
        """Return the files of an origin and their sha256 from the lock; empty if the lock does not have it."""
        return self.lock.sources[id].files if self.lock is not None and id in self.lock.sources else {}


class Lookup(Struct):
    """The folder of the file with a reference, the environment, and the run; a fetched recipe `is_confined`."""

    folder: Path
    environment: Mapping[str, str]
    fetching: Fetching
    is_confined: bool = False


def source_in(origin: Origin, reference: Reference) -> Source:
    """Return the file that a reference names in `origin`. Raises SourceError."""
    inside = PurePosixPath(reference.path)
    if inside.is_absolute() or ".." in inside.parts or "\\" in reference.path:
        raise SourceError("source-kind", f"the model reference `{reference.text}` leads outside its source")
    existing = [origin.named(each) for each in model_files(origin.root, depth=6, meshes=is_mesh(inside))]
    for left_out, why in origin.without:
        if inside.is_relative_to(left_out):
            message = f"the model `{reference.text}` does not exist: `{left_out}` is {why}"
            notes = (exists_note("model file", existing, reference.text).message,)
            raise SourceError("source-not-found", message, notes=notes)
    if not has_format(inside):
        raise without_suffix(reference.text, existing)
    path = origin.root / inside
    if not os.path.isfile(path):
        raise not_found(reference.text, path, existing)
    return Source(
        path,
        reference.kind,
        reference.text,
        version=origin.pin,
        licenses=license.find(path, origin.root),
        origin=origin,
    )


def unlocked(reference: Reference, fetching: Fetching) -> SourceError:
    """Return the error for a source that is not in the lock when only locked sources are allowed."""
    message = f"`{reference.text}` is not in the lock"
    return SourceError("lock-stale", message, help=f"run `mjcompose lock {fetching.recipe}` and commit the lock")


def not_at_hand(reference: Reference, where: str = "the store") -> SourceError:
    """Return the error for a source that is missing in `where` when nothing may be fetched."""
    message = f"`{reference.text}` is not in {where}, and nothing is fetched offline"
    return SourceError("source-offline", message, help="run it once without `--offline` or `--frozen`")


_DEPTH = 3
_ENTRIES = 2000


def model_files(folder: Path, depth: int = _DEPTH, meshes: bool = False) -> list[str]:
    """Return the model files in `folder` and up to `depth` levels below, as relative paths, the nearest first.

    Only with `meshes`, they include meshes, most of which belong to a model. Hidden files are left out, and the search
    ends after 2000 entries. Empty if the folder does not exist.
    """
    found: list[str] = []
    seen = 0
    level = [""]
    for _ in range(depth + 1):
        below: list[str] = []
        for inner in level:
            try:
                entries = sorted(os.scandir(folder / inner), key=lambda entry: entry.name)
            except OSError:
                continue
            for entry in entries:
                seen += 1
                if seen > _ENTRIES:
                    return found
                relative = f"{inner}/{entry.name}" if inner else entry.name
                if entry.name.startswith("."):
                    continue
                if entry.is_dir(follow_symlinks=False):
                    if not entry.name.startswith("__"):
                        below.append(relative)
                elif has_format(PurePath(entry.name)) and (meshes or not is_mesh(PurePath(entry.name))):
                    found.append(relative)
        level = below
    return found


def not_found(text: str, wanted: Path, existing: Iterable[str], *, hint: str | None = None) -> SourceError:
    """Return the error for a reference whose file does not exist; `existing` are references to existing files."""
    suffix = PurePath(text).suffix.lower()
    # Files with the same suffix first: recipes are no use to somebody who looks for an XML file.
    known = sorted(existing, key=lambda each: PurePath(each).suffix.lower() != suffix)
    near = nearest(text, known)
    shown = [near, *(each for each in known if each != near)] if near else known
    message = f"the model `{text}` does not exist"
    note = exists_note("model file", shown).message
    if "\\" in text:  # part of a name, except on Windows
        hint = f"paths are written with `/`: write `{near or text.replace(chr(92), '/')}`"
        if near is None and PureWindowsPath(text).drive:
            hint = "paths are written with `/` and are best relative to the recipe: `./models/arm.xml`"
        near = None
    elif not os.path.isdir(wanted.parent):  # `Path.is_dir` raises for a path that is too long
        message, note, corrected = _without_folder(text, wanted)
        near = corrected or near
    return SourceError(
        "source-not-found",
        message,
        notes=(f"looked for `{wanted}`", note),
        help=f"write `{near}`" if near else hint,
    )


def _without_folder(text: str, wanted: Path) -> tuple[str, str, str | None]:
    """For a file in a missing folder, return the message, the existing folders, and the path with the nearest."""
    missing = next(
        each for each in (wanted.parent, *wanted.parent.parents) if os.path.isdir(each.parent) or each == each.parent
    )
    depth = len(wanted.parts) - len(missing.parts)
    written = text.removesuffix("".join(f"/{part}" for part in wanted.parts[-depth:]))
    try:
        folders = sorted(each.name for each in os.scandir(missing.parent) if each.is_dir() and each.name[0] != ".")
    except OSError:
        folders = []
    near = closest(missing.name, folders)
    inside = written.removesuffix(missing.name)
    message = f"the model `{text}` does not exist, nor does the folder `{written}`"
    listed = sorted(folders, key=lambda each: each not in near)
    note = f"`{missing.parent}` contains no folders"
    if listed:
        note = exists_note("folder", [f"{inside}{each}" for each in listed]).message
    corrected = missing.with_name(near[0]).joinpath(*wanted.parts[-depth:]) if near else None
    exists = corrected is not None and os.path.isfile(corrected)
    return message, note, f"{inside}{near[0]}{text.removeprefix(written)}" if exists else None


def nearest(text: str, existing: Iterable[str]) -> str | None:
    # Otherwise a dot would count as the end of a prefix, and all `.xml` files as one name with different prefixes.
    flat = {each.removeprefix("./").replace(".", "_"): each for each in existing}
    near = closest(text.replace("\\", "/").removeprefix("./").replace(".", "_"), flat)
    return flat[near[0]] if near else None


def without_suffix(text: str, existing: Iterable[str]) -> SourceError:
    """Return the error for a reference whose suffix is missing or unknown."""
    known = list(existing)
    suffix = PurePath(text.rpartition("#")[2]).suffix
    same = [
        model_file
        for model_file in known
        if os.path.splitext(model_file)[0].removeprefix("./") == text.removeprefix("./")
    ]
    same = same or [model_file for model_file in known if PurePath(model_file).stem == text]
    near = same[0] if same else nearest(text, known)
    foreign = foreign_format(PurePath(text))
    if foreign is not None:
        stem = text.removesuffix(suffix)
        beside = next((model_file for model_file in known if os.path.splitext(model_file)[0] == stem), None)
        help = f"write `{beside}`" if beside else foreign.help(text)
        return SourceError("source-kind", foreign.message(text), help=help)
    if suffix.lower() in (".zip", ".mjz", ".mjb"):
        problem = "is a bundle, which cannot be a part"
        fix = "refer to the recipe or the XML that it was built from"
    else:
        problem = f"ends in `{suffix}`, which is not a model file" if suffix else "has no file suffix"
        fix = (
            "end it in `.yaml` for a recipe, `.xml` for MJCF, `.urdf` for URDF, `.obj`, `.stl` or `.msh` for a mesh, or"
            " write `menagerie:ROBOT`"
        )
    return SourceError(
        "source-kind",
        f"the model reference `{text}` {problem}",
        notes=(exists_note("model file", known).message,) if known else (),
        help=f"write `{near}`" if near else fix,
    )
