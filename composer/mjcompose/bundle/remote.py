"""Bundles at addresses such as `s3://bucket/cell.zip`, through `fsspec`, and bundles that share a folder of assets.

An object store has no folders and cannot rename: a bundle there is complete if its manifest exists, which is
written last and removed first. A single file is written in one step.

Neighboring folders can share one folder of assets: `NAME/model.xml` refers to `../assets/…`. The name of a shared asset
contains a hash of its content, so it is the same file for all models, no matter which of them are written, in which
order and by how many processes. Other files (manifest, licenses, submodels) are not shared.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path, PurePosixPath
from typing import Any, TypeAlias

from lxml import etree

from mjcompose.base.diagnostic import DiagnosticError, hide
from mjcompose.base.files import read_regular
from mjcompose.bundle.bundle import MANIFEST, Bundle, OutputError, files_in, to_text
from mjcompose.bundle.manifest import from_json
from mjcompose.bundle.staging import check_own_place, staged_file, write_folder
from mjcompose.tree.files import CUBE, NAMED_AFTER_FILE, file_attributes, stem
from mjcompose.tree.xml_text import write

FileSystem: TypeAlias = Any
"""An `fsspec.AbstractFileSystem`."""


class RemoteError(Exception):
    """An invalid address, or an error of its file system."""


@contextmanager
def open_remote(address: str) -> Iterator[tuple[FileSystem, str]]:
    """Yield the file system of an address and the path in it; its errors inside the block become RemoteError."""
    try:
        import fsspec
    except ImportError:
        raise RemoteError('addresses need the Python package `fsspec`: run `pip install "mjcompose[remote]"`') from None
    try:
        fs, path = fsspec.core.url_to_fs(address)
        fs.invalidate_cache()
        yield fs, path.rstrip("/")
    except (RemoteError, DiagnosticError):
        raise
    except Exception as error:  # each file system raises its own exceptions
        raise RemoteError(hide(" ".join(str(error).split()) or type(error).__name__)) from error


@contextmanager
def _writing(address: str) -> Iterator[tuple[FileSystem, str]]:
    try:
        with open_remote(address) as found:
            yield found
    except RemoteError as error:
        help = "check that its file system is installed, and that you can write there"
        raise OutputError("output-unwritable", f"cannot write `{hide(address)}`: {error}", help) from error


def check_writable(address: str) -> None:
    """Write something below an address and remove it again. Raises OutputError."""
    with _writing(address) as (fs, path):
        probe = f"{path}/.mjcompose-{os.urandom(6).hex()}"
        _put(fs, probe, b"mjcompose looks whether it may write here")
        fs.rm_file(probe)


def deliver_file(file: Path, address: str) -> None:
    """Write a copy of a file to an address. Raises OutputError, and OSError if the file cannot be read."""
    with _writing(address) as (fs, path):
        _put(fs, path, read_regular(file, is_source=False))


def deliver_folder(folder: Path, address: str) -> None:
    """Write a bundle to an address, replacing an earlier one. Raises OutputError."""
    with _writing(address) as (fs, path):
        there = {each[len(path) + 1 :] for each in fs.find(path)}
        known = _listed(fs, f"{path}/{MANIFEST}") if MANIFEST in there else set()
        foreign = sorted(there - known)
        if foreign:
            message = f"replacing `{hide(address)}` would delete files that mjcompose did not write: `{foreign[0]}`"
            raise OutputError("output-unwritable", message, "move them elsewhere, or choose another address")
        new = {each.relative_to(folder).as_posix(): each for each in folder.rglob("*") if os.path.isfile(each)}
        if MANIFEST in there:
            fs.rm_file(f"{path}/{MANIFEST}")
        for name in sorted(new, key=lambda name: name == MANIFEST):
            _put(fs, f"{path}/{name}", read_regular(new[name], is_source=False))
        for name in sorted(there - new.keys()):
            fs.rm_file(f"{path}/{name}")


def deliver_assets(folder: Path, address: str) -> None:
    """Upload shared assets, which are named after their contents, unless they exist. Raises OutputError."""
    with _writing(address) as (fs, path):
        for file in sorted(folder.iterdir()):
            at = f"{path}/{file.name}"
            content = read_regular(file, is_source=False)
            if not (fs.exists(at) and fs.info(at)["size"] == len(content)):
                _put(fs, at, content)


def manifest_at(address: str) -> bytes:
    """Return the manifest of a bundle at an address. Raises OSError and the exceptions of `zipfile`."""
    try:
        with open_remote(address) as (fs, path):
            if path.endswith((".zip", ".mjz")):
                with fs.open(path) as stream, zipfile.ZipFile(stream) as archive:
                    return archive.read(MANIFEST)
            manifest: bytes = fs.cat_file(f"{path}/{MANIFEST}")
            return manifest
    except RemoteError as error:
        raise OSError(str(error)) from error


def stamps(address: str) -> list[list[object]]:
    """Return data that changes with the contents at an address; empty if there are none. Never raises."""
    try:
        with open_remote(address) as (fs, path):
            found = fs.find(path, detail=True) if fs.isdir(path) else {path: fs.info(path)}
    except RemoteError:
        return []
    keys = ("ETag", "etag", "md5", "mtime", "created")
    return [
        [name, about.get("size"), str(next((about[key] for key in keys if key in about), ""))]
        for name, about in sorted(found.items())
    ]


def download(address: str, folder: Path, files: int, size: int) -> Path:
    """Download a bundle with its shared assets to an empty folder; return its path. Raises RemoteError."""
    name = PurePosixPath(address.rstrip("/")).name
    with open_remote(address) as (fs, path):
        if not fs.isdir(path):
            _check(fs.info(path)["size"], 1, files, most=size)
            fs.get_file(path, str(folder / name))
            return folder / name
        found = {each[len(path) + 1 :]: about["size"] for each, about in fs.find(path, detail=True).items()}
        _check(sum(found.values()), len(found), files, most=size)
        for each in sorted(found):
            _fetch(fs, f"{path}/{each}", folder / "models" / name, inside=each)
        beside = [each for each in _listed(fs, f"{path}/{MANIFEST}") if each.startswith("../")]
        for each in beside:
            up = each.count("../")
            above = path.rsplit("/", up)[0]
            inside = each.removeprefix("../" * up)
            if inside.startswith(f"{ASSETS}/") and ".." not in PurePosixPath(inside).parts and up <= 2:
                _check(fs.info(f"{above}/{inside}")["size"], len(beside), files, most=size)
                _fetch(fs, f"{above}/{inside}", (folder / "models", folder)[up - 1], inside=inside)
        return folder / "models" / name


def _fetch(fs: FileSystem, path: str, folder: Path, inside: str) -> None:
    if PurePosixPath(inside).is_absolute() or ".." in PurePosixPath(inside).parts:
        raise RemoteError(f"`{inside}` leads out of it")
    target = folder / inside
    target.parent.mkdir(parents=True, exist_ok=True)
    fs.get_file(path, str(target))


def _check(size: int, count: int, files: int, most: int) -> None:
    if count > files or size > most:
        raise RemoteError(f"it has {count} files of {size} bytes, and {files} of {most} are allowed")


def _put(fs: FileSystem, path: str, content: bytes) -> None:
    fs.makedirs(path.rpartition("/")[0], exist_ok=True)
    with fs.transaction:
        fs.pipe_file(path, content)


def _listed(fs: FileSystem, path: str) -> set[str]:
    """Return the files in a manifest, including the manifest; nothing if it is not a manifest."""
    with suppress(OSError):
        return files_in(fs.cat_file(path)) or set()
    return set()


ASSETS = "assets"
_SHARED = re.compile(rf"((?:\.\./){{1,2}}){ASSETS}/([^/]+)")


def write_shared(bundle: Bundle, out: Path, above: int = 1) -> tuple[Path, ...]:
    """Write the folder `out`, and its assets to the folder `assets` next to it (`above` 1) or one level higher (2).

    Return the paths of the assets. Raises OutputError, and then leaves `out` as it was.
    """
    if out.name.casefold() == ASSETS:  # many file systems ignore case
        raise OutputError("output-kind", f"the folder `{out}` is for assets", "give the model another name")
    own, assets = split_shared_assets(bundle, above)
    folder = out.parents[above - 1] / ASSETS
    for name, content in assets.items():
        path = folder / name
        is_there = False
        with suppress(OSError):
            is_there = os.stat(path).st_size == len(content) and read_regular(path, is_source=False) == content
        if not is_there:
            check_own_place(path)
            with staged_file(path) as stage:
                stage.write_bytes(content)
    write_folder(own, out)
    return tuple(folder / name for name in assets)


def split_shared_assets(bundle: Bundle, above: int = 1) -> tuple[Bundle, dict[str, bytes]]:
    """Return the bundle without its assets, and the assets by their names in the folder `above` levels up. No I/O."""
    beside = f"{'../' * above}{ASSETS}/"
    root = etree.fromstring(bundle.files[bundle.model])
    moved: dict[str, str] = {}
    for element, attribute, path in list(file_attributes(root)):
        if path not in bundle.files:
            continue
        file = PurePosixPath(path)
        moved[path] = f"{file.stem}-{bundle.digest(path)[:16]}{file.suffix}"
        if element.tag in NAMED_AFTER_FILE and not element.get("name") and attribute not in CUBE:
            element.set("name", stem(path))
        element.set(attribute, beside + moved[path])
    files = {path: content for path, content in bundle.files.items() if path not in moved}
    files[bundle.model] = write(root)
    names = {path: beside + name for path, name in moved.items()}
    files[MANIFEST] = _with_shared(bundle.files[MANIFEST], names, bundle.model, text=files[bundle.model])
    return Bundle(files, bundle.model), {name: bundle.files[path] for path, name in moved.items()}


def with_shared_assets(files: Mapping[str, bytes], folder: Path) -> dict[str, bytes]:
    """Return the files of such a folder, with shared assets in its manifest, as a bundle of its own. Raises OSError."""
    try:
        manifest = from_json(files.get(MANIFEST, b""))
    except ValueError:  # the reader of the bundle reports it
        return dict(files)
    model = manifest.model
    found = dict(files)
    shared = filter(None, (_SHARED.fullmatch(each.path) for each in manifest.files))
    names = {parts[0]: f"{ASSETS}/{parts[2]}" for parts in shared}
    if not names or model not in files:
        return found
    try:
        root = etree.fromstring(files[model])
    except etree.XMLSyntaxError:  # likewise
        return found
    for path, inside in names.items():
        file = folder / path
        if os.path.isfile(file) and not file.is_symlink():
            found[inside] = read_regular(file)
    for element, attribute, path in list(file_attributes(root)):
        if path in names:
            element.set(attribute, names[path])
    text = write(root)
    digest = hashlib.sha256(files[model]).hexdigest()
    is_listed = any(each.path == model and each.sha256 == digest for each in manifest.files)
    # The reader reports a model that is not the listed one.
    found[MANIFEST] = _with_shared(files[MANIFEST], names, model, text=text if is_listed else None)
    found[model] = text
    return found


def _with_shared(manifest: bytes, names: Mapping[str, str], model: str, text: bytes | None) -> bytes:
    """Return the manifest with other paths for its files, and another text of the model."""
    data: dict[str, Any] = json.loads(manifest)
    for each in data["files"]:
        each["path"] = names.get(each["path"], each["path"])
        if each["path"] == model and text is not None:
            each["sha256"] = hashlib.sha256(text).hexdigest()
            each["size"] = len(text)
    once = {each["path"]: each for each in data["files"]}
    data["files"] = [once[path] for path in sorted(once)]
    return to_text(data)
