"""Load one bundle, or many, as models in this process, with the manifest and an index of names."""

from __future__ import annotations

import atexit
import os
from collections.abc import Hashable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import field
from functools import partial
from hashlib import sha256
from os import PathLike
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, hide, warn
from mjcompose.base.files import read_regular
from mjcompose.base.limits import in_force
from mjcompose.base.report import short_traceback
from mjcompose.base.scratch import scratch
from mjcompose.base.sink import Sink
from mjcompose.bundle.bundle import LARGEST_MANIFEST, MANIFEST, Bundle, Location, is_address, path_of_bundle
from mjcompose.bundle.listing import ListingError, RowCondition, rows
from mjcompose.bundle.manifest import Manifest, check_files, check_index, index_of, manifest_of
from mjcompose.bundle.read import ReadError, files_outside, named_model, read
from mjcompose.bundle.staging import manifest_beside, write_files
from mjcompose.mujoco.attributes import names
from mjcompose.mujoco.index import index as compiled_index
from mjcompose.text.expression import Value
from mjcompose.tools.worlds.names import BundleWarning, Index, LoadError, failure

Model: TypeAlias = Any
"""A `mujoco.MjModel`, which has no type stubs."""


class Loaded(NamedTuple):
    """A model, its manifest, and the index of its names. `model` is a `mujoco.MjModel`."""

    model: Model
    manifest: Manifest
    index: Index  # type: ignore[assignment]  # the method of a tuple that it hides is of no use here


@short_traceback
def load(bundle: str | PathLike[str], *, allow_changes: bool = False) -> Loaded:
    """Load the output of `mjcompose build`: a folder, a `.zip`, an `.mjz`, or an `.mjb`.

    An `.mjb` needs its manifest next to it. Other forms may be at an address, such as `s3://bucket/cell.zip`.

        model, manifest, index = mjcompose.load("build/cell.zip")
        data = mujoco.MjData(model)
        data.qpos[index.qpos["left/elbow"]] = 0.5

    Files are compared with the hashes of the manifest, and the addresses of the compiled model with its index; a
    difference is an error, with `allow_changes` a warning. The returned index always belongs to the compiled model. A
    model that another version of MuJoCo verified is loaded with a warning.

    Raises LoadError; warns with BundleWarning.
    """
    shown = path_of_bundle(bundle)
    if is_address(shown):
        with scratch("download") as folder:
            return _load(_downloaded(shown, folder), shown, allow_changes=allow_changes)
    return _load(Path(bundle), shown, allow_changes=allow_changes)


def _downloaded(address: str, folder: Path) -> Path:
    from mjcompose.bundle.remote import RemoteError, download

    try:
        return download(address, folder, in_force().output_files, size=in_force().output_size)
    except RemoteError as error:
        raise failure("file-unreadable", f"cannot read `{hide(address)}`: {error}") from error


def _load(path: Path, shown: str, *, allow_changes: bool) -> Loaded:
    import mujoco

    is_binary = path.suffix.lower() == ".mjb" and not os.path.isdir(path)
    checked = (_read_binary if is_binary else _checked)(path, shown)
    manifest = checked.manifest
    with _on_disk(checked, shown, allow_changes) as file:
        _check_version(manifest, mujoco.__version__, shown, is_binary=is_binary)
        model = _compiled(mujoco, file, shown)
    listed: Any = index_of(compiled_index(model, mujoco))
    if manifest.index is not None:
        sink = Sink()
        check_index(manifest.index, listed, shown, sink=sink)
        _raise_or_warn(sink.errors, allow_changes)
        listed = _with_places(listed, manifest)
    return Loaded(model, manifest, Index(listed, partial(names, model), manifest.separator))


class _Checked(NamedTuple):
    """A bundle, and its differences from its manifest. `kept` is the bundle on disk if it was checked before."""

    key: Hashable
    manifest: Manifest
    bundle: Bundle | None
    faults: Sequence[Diagnostic] = ()
    kept: _Kept | None = None


def _checked(path: Path, shown: str) -> _Checked:
    try:
        content = None
        if os.path.isfile(path):
            content = read_regular(path, in_force().output_size)
            key = (sha256(content).hexdigest(), in_force())
            kept = _taken(key)
            if kept is not None:
                return _Checked(key, kept.manifest, None, kept=kept)
        return _compare(read(path, content=content), shown, content)
    except OSError as error:
        raise failure("file-unreadable", f"cannot read `{path}`: {error.strerror or error}") from error
    except ReadError as error:
        raise failure(error.code, error.message, error.help) from error


def _compare(bundle: Bundle, shown: str, content: bytes | None = None) -> _Checked:
    """Compare the files of a bundle with its manifest; `content` are the bytes of its archive."""
    sink = Sink()
    manifest = manifest_of(bundle.files.get(MANIFEST), shown, sink)
    if manifest is None:
        raise LoadError(sink.errors)
    check_files(bundle, manifest, shown, sink=sink)
    key = (bundle.sha256 if content is None else sha256(content).hexdigest()), in_force()
    return _Checked(key, manifest, bundle, faults=sink.errors, kept=_taken(key))


def _read_binary(path: Path, shown: str) -> _Checked:
    """Read and compare the two files under their current names: the manifest has the original name of the model."""
    beside = manifest_beside(path)
    try:
        content = read_regular(path)
        manifest = read_regular(beside, LARGEST_MANIFEST)
    except FileNotFoundError as error:
        if not os.path.exists(path):
            raise failure("file-not-found", f"the file `{path}` does not exist") from error
        message = f"`{beside}`, the manifest of `{path.name}`, does not exist"
        raise failure("bundle-manifest", message, "keep the two together") from error
    except OSError as error:
        file = error.filename or path
        raise failure("file-unreadable", f"cannot read `{file}`: {error.strerror or error}") from error
    named = named_model(manifest)
    model = named if named.endswith(".mjb") and Path(named).name == named else path.name
    return _compare(Bundle({model: content, MANIFEST: manifest}, model), shown)


class _Kept(Struct):
    """A checked bundle in a folder of its own; `stamps` has the size and time of each file when it was written."""

    manifest: Manifest
    file: Path
    stamps: Mapping[Path, tuple[int, int]]
    folder: ExitStack
    owner: int = field(default_factory=os.getpid)

    @property
    def size(self) -> int:
        return sum(size for size, _ in self.stamps.values())

    @property
    def is_intact(self) -> bool:
        """Whether nothing was removed or changed, and the process was not forked since."""
        try:
            return self.owner == os.getpid() and all(_stamp(path) == at for path, at in self.stamps.items())
        except OSError:
            return False


# As much as MuJoCo's cache holds; the oldest go first. They are removed when the process ends.
_KEPT_BYTES = 500 * 2**20
_kept: dict[Hashable, _Kept] = {}
_lock = Lock()


def _stamp(path: Path) -> tuple[int, int]:
    status = path.lstat()
    return status.st_size, status.st_mtime_ns


@contextmanager
def _on_disk(checked: _Checked, shown: str, allow_changes: bool) -> Iterator[Path]:
    """Yield the path of the model in a folder with the checked files, which only the block uses."""
    _raise_or_warn(checked.faults, allow_changes)
    kept = checked.kept or _written(checked, shown)
    try:
        yield kept.file
    finally:
        if checked.faults:
            kept.folder.close()  # the next load reports them again
        else:
            _keep(checked.key, kept)


def _written(checked: _Checked, shown: str) -> _Kept:
    bundle = checked.bundle
    assert bundle is not None
    with ExitStack() as stack:
        folder = stack.enter_context(scratch("bundle"))
        write_files(bundle, folder)
        file = folder / bundle.model
        found = files_outside(file.parent, file.name, shown)
        if found:
            raise LoadError(found)
        stamps = {path: _stamp(path) for path in (folder / name for name in bundle.files)}
        return _Kept(checked.manifest, file, stamps, folder=stack.pop_all())


def _taken(key: Hashable) -> _Kept | None:
    """Take the bundle that is kept under a key, if nothing changed it."""
    with _lock:
        kept = _kept.pop(key, None)
    if kept is None or kept.is_intact:
        return kept
    kept.folder.close()
    return None


def _keep(key: Hashable, kept: _Kept) -> None:
    with _lock:
        gone = [_kept.pop(key)] if key in _kept else []
        _kept[key] = kept
        while sum(each.size for each in _kept.values()) > _KEPT_BYTES:
            gone.append(_kept.pop(next(iter(_kept))))
    for each in gone:
        each.folder.close()


@atexit.register
def _forget() -> None:
    while _kept:
        _kept.popitem()[1].folder.close()


def _compiled(mujoco: Any, file: Path, shown: str) -> Model:
    is_binary = file.suffix.lower() == ".mjb"
    model = mujoco.MjModel
    try:
        return model.from_binary_path(str(file)) if is_binary else model.from_xml_path(str(file))
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        reason = " ".join(str(error).replace(str(file.parent), "").split())
        raise failure("mujoco-rejects", f"MuJoCo {mujoco.__version__} does not load `{shown}`: {reason}") from error


def _check_version(manifest: Manifest, running: str, shown: str, is_binary: bool) -> None:
    made_with = manifest.mujoco
    if made_with == running:
        return
    if is_binary:
        message = f"`{shown}` was compiled by MuJoCo {made_with}, and this is {running}: no other version reads it"
        raise failure("mujoco-rejects", message, f"build it again, or install `mujoco=={made_with}`")
    verifier = "no MuJoCo" if made_with is None else f"MuJoCo {made_with}"
    warn(f"`{shown}` was verified by {verifier}, and this is {running}", BundleWarning)


def _with_places(listed: Any, manifest: Manifest) -> Any:
    """Return the compiled index with the origins of elements, which only the manifest knows."""
    assert manifest.index is not None
    kept = {}
    for kind in type(listed).model_fields:
        ours = getattr(listed, kind)
        theirs = getattr(manifest.index, kind)
        if [each.name for each in ours] == [each.name for each in theirs]:
            pairs = zip(ours, theirs, strict=True)
            kept[kind] = tuple(each.model_copy(update={"origin": other.origin}) for each, other in pairs)
    return listed.model_copy(update=kept)


def _raise_or_warn(faults: Sequence[Diagnostic], allowed: bool) -> None:
    if faults and not allowed:
        raise LoadError(faults)
    for each in faults:
        warn(each.message, BundleWarning)


class ListedModel(Struct):
    """A model of an index that is not loaded yet: its name, its place, and its values.

    `values` are the columns of the index: values of the matrix and of draws, sizes, the sha256.
    """

    name: str
    path: Location
    values: Mapping[str, Value]

    def load(self, *, allow_changes: bool = False) -> Loaded:
        """Load the model as `mjcompose.load` does. Raises LoadError."""
        return load(self.path, allow_changes=allow_changes)


def load_many(path: str | PathLike[str], where: str | None = None) -> Iterator[ListedModel]:
    """Yield the models that `mjcompose build --all` wrote to a folder, one after another, without loading them.

        for each in mjcompose.load_many("build/study", where="payload > 2"):
            model, manifest, index = each.load()

    `path` may be an address, such as `s3://bucket/study`, or the index itself. `where` is an expression as in
    recipes, on the columns of the index. Raises LoadError, at the first model.
    """
    try:
        condition = None if where is None else RowCondition(where)
        shown = path_of_bundle(path)
        for row in rows(shown if is_address(shown) else Path(path), shown):
            if condition is None or condition.holds(row):
                yield ListedModel(str(row.values.get("model", "")), row.file, row.values)
        if condition is not None:
            condition.check()
    except ListingError as error:
        raise LoadError([error.diagnostic]) from error
