"""Load a bundle as a model in this process, with its manifest and an index of its names."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from composer.bundle.admitted import outside
from composer.bundle.bundle import MANIFEST, Bundle
from composer.bundle.integrity import check_files, check_index, manifest_of
from composer.bundle.manifest import Manifest
from composer.bundle.manifest_index import index_of
from composer.bundle.mjb import manifest_beside
from composer.bundle.place import is_address
from composer.bundle.read import ReadError, ReadLimits, named_model, read
from composer.bundle.staging import write_files
from composer.compiled import index as compiled_index
from composer.compiled.kinds import names
from composer.diagnostics.secret import hide
from composer.diagnostics.sink import Sink
from composer.loading.errors import BundleWarning, LoadError
from composer.loading.index import Index
from composer.scratch import scratch

Model: TypeAlias = Any
"""A `mujoco.MjModel`, which has no type stubs."""


class Loaded(NamedTuple):
    """A model, its manifest, and the index of its names.

    `model` is a `mujoco.MjModel`.
    """

    model: Model
    manifest: Manifest
    index: Index  # type: ignore[assignment]  # the method of a tuple that it hides is of no use here


def load(bundle: str | PathLike[str], *, allow_changes: bool = False) -> Loaded:
    """Load the output of `mjcompose build`: a folder, a `.zip`, an `.mjz`, or an `.mjb`.

    An `.mjb` needs its manifest next to it. Other forms may be at an address, such as `s3://bucket/cell.zip`.

        model, manifest, index = composer.load("build/cell.zip")
        data = mujoco.MjData(model)
        data.qpos[index.qpos["left/elbow"]] = 0.5

    Files are compared with the hashes of the manifest, and the addresses of the compiled model with its index;
    what differs is an error, with `allow_changes` a warning. The index that is given is always that of the compiled
    model. A model that another version of MuJoCo verified is loaded with a warning.

    Raises LoadError; warns with BundleWarning.
    """
    shown = os.fspath(bundle)
    if is_address(shown):
        with scratch("download") as folder:
            return _load(_downloaded(shown, folder), shown, allow_changes=allow_changes)
    return _load(Path(bundle), shown, allow_changes=allow_changes)


def _downloaded(address: str, folder: Path) -> Path:
    from composer.bundle.remote import RemoteError, download

    limits = ReadLimits()
    try:
        return download(address, folder, limits.files, limits.bytes)
    except RemoteError as error:
        raise _failure("file-unreadable", f"cannot read `{hide(address)}`: {error}") from error


def _load(path: Path, shown: str, *, allow_changes: bool) -> Loaded:
    import mujoco

    sink = Sink()
    is_binary = path.suffix.lower() == ".mjb" and not os.path.isdir(path)
    read_bundle = _read_binary(path) if is_binary else _read(path)
    manifest = manifest_of(read_bundle.files.get(MANIFEST), shown, sink)
    if manifest is None:
        raise LoadError(sink.errors)
    check_files(read_bundle, manifest, shown, sink)
    _raise_or_warn(sink, allow_changes)
    _check_version(manifest, mujoco.__version__, shown, is_binary)
    with _on_disk(read_bundle) as file:
        if found := outside(file.parent, file.name, shown):
            raise LoadError(found)
        model = _compiled(mujoco, file, shown)
    listed = _listed(mujoco, model)
    if manifest.index is not None:
        check_index(manifest.index, listed, shown, sink := Sink())
        _raise_or_warn(sink, allow_changes)
        listed = _with_places(listed, manifest)
    return Loaded(model, manifest, Index(listed, partial(names, model), manifest.separator))


def _read(path: Path) -> Bundle:
    try:
        return read(path)
    except ReadError as error:
        raise _failure(error.code, error.message, error.help) from error


def _read_binary(path: Path) -> Bundle:
    """Read the two files under their current names: the manifest has the original name of the model."""
    beside = manifest_beside(path)
    try:
        content = path.read_bytes()
        manifest = beside.read_bytes()
    except FileNotFoundError as error:
        if not os.path.exists(path):
            raise _failure("file-not-found", f"the file `{path}` does not exist") from error
        message = f"`{beside}`, the manifest of `{path.name}`, does not exist"
        raise _failure("bundle-manifest", message, "keep the two together") from error
    except OSError as error:
        shown = error.filename or path
        raise _failure("file-unreadable", f"cannot read `{shown}`: {error.strerror or error}") from error
    named = named_model(manifest)
    model = named if named.endswith(".mjb") and Path(named).name == named else path.name
    return Bundle({model: content, MANIFEST: manifest}, model)


@contextmanager
def _on_disk(bundle: Bundle) -> Iterator[Path]:
    """Write the files that were checked to a folder, and yield the path of the model."""
    with scratch("bundle") as folder:
        write_files(bundle, Path(folder))
        yield Path(folder) / bundle.model


def _compiled(mujoco: Any, file: Path, shown: str) -> Model:
    try:
        if file.suffix.lower() == ".mjb":
            return mujoco.MjModel.from_binary_path(str(file))
        return mujoco.MjModel.from_xml_path(str(file))
    except (ValueError, RuntimeError, mujoco.FatalError) as error:
        said = " ".join(str(error).replace(str(file.parent), "").split())
        raise _failure(
            "mujoco-rejects", f"MuJoCo {mujoco.__version__} does not load `{shown}`: {said}"
        ) from error


def _check_version(manifest: Manifest, running: str, shown: str, is_binary: bool) -> None:
    made_with = manifest.mujoco
    if made_with == running:
        return
    if is_binary:
        raise _failure(
            "mujoco-rejects",
            f"`{shown}` was compiled by MuJoCo {made_with}, and this is {running}: no other version reads it",
            f"build it again, or install `mujoco=={made_with}`",
        )
    said = "was verified by no MuJoCo" if made_with is None else f"was verified by MuJoCo {made_with}"
    message = f"`{shown}` {said}, and this is {running}"
    warnings.warn(message, BundleWarning, stacklevel=4)


def _listed(mujoco: Any, model: Model) -> Any:
    return index_of(compiled_index.Index.from_data(compiled_index.index(model, mujoco)))


def _with_places(listed: Any, manifest: Manifest) -> Any:
    """Return the compiled index with the origins of elements, which only the manifest knows."""
    assert manifest.index is not None
    kept = {}
    for kind in type(listed).model_fields:
        ours, theirs = getattr(listed, kind), getattr(manifest.index, kind)
        same = [each.name for each in ours] == [each.name for each in theirs]
        kept[kind] = tuple(
            each.model_copy(update={"origin": other.origin}) for each, other in zip(ours, theirs, strict=True)
        ) if same else ours  # fmt: skip
    return listed.model_copy(update=kept)


def _raise_or_warn(sink: Sink, allowed: bool) -> None:
    if not sink.has_errors:
        return
    if not allowed:
        raise LoadError(sink.errors)
    for each in sink.errors:
        warnings.warn(each.message, BundleWarning, stacklevel=4)


def _failure(code: str, message: str, help: str | None = None) -> LoadError:
    sink = Sink()
    sink.error(code, message, help=help)
    return LoadError(sink.errors)
