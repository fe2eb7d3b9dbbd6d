"""Outputs and bundles at addresses such as `s3://bucket/cell.zip`, accessed through `fsspec`.

An object store has no folders and cannot rename: a bundle there is complete if its manifest exists, which is
written last and removed first. A single file is written in one step.
"""

from __future__ import annotations

import os
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any, TypeAlias

from composer.bundle.bundle import MANIFEST
from composer.bundle.output_error import OutputError
from composer.bundle.shared import ASSETS
from composer.diagnostics.error import DiagnosticError
from composer.diagnostics.secret import hide
from composer.reading.regular import read_regular

FileSystem: TypeAlias = Any
"""An `fsspec.AbstractFileSystem`."""


class RemoteError(Exception):
    """An invalid address, or an error of its file system."""


@contextmanager
def opened(address: str) -> Iterator[tuple[FileSystem, str]]:
    """Yield the file system of an address and the path in it; its errors inside the block become RemoteError."""
    try:
        import fsspec
    except ImportError:
        raise RemoteError(
            'addresses need the Python package `fsspec`: run `pip install "mjcompose[remote]"`'
        ) from None
    try:
        fs, path = fsspec.core.url_to_fs(address)
        fs.invalidate_cache()
        yield fs, path.rstrip("/")
    except (RemoteError, DiagnosticError):
        raise
    except Exception as error:  # each file system raises its own exceptions
        said = " ".join(str(error).split()) or type(error).__name__
        raise RemoteError(hide(said)) from error


@contextmanager
def _writing(address: str) -> Iterator[tuple[FileSystem, str]]:
    try:
        with opened(address) as found:
            yield found
    except RemoteError as error:
        help = "see that its file system is installed, and that you may write there"
        raise OutputError("output-unwritable", f"cannot write `{hide(address)}`: {error}", help) from error


def check_writable(address: str) -> None:
    """Write something below an address and remove it again. Raises OutputError."""
    with _writing(address) as (fs, path):
        probe = f"{path}/.mjcompose-{os.urandom(6).hex()}"
        _put(fs, probe, b"mjcompose looks whether it may write here")
        fs.rm_file(probe)


def deliver_file(file: Path, address: str) -> None:
    """Write a file to an address in one step. Raises OutputError."""
    with _writing(address) as (fs, path):
        _put(fs, path, read_regular(file, is_source=False))


def deliver_folder(folder: Path, address: str) -> None:
    """Write a bundle to an address, replacing an earlier one. Raises OutputError."""
    with _writing(address) as (fs, path):
        there = {each[len(path) + 1 :] for each in fs.find(path)}
        known = _listed(fs, f"{path}/{MANIFEST}") if MANIFEST in there else None
        if there and (known is None or there - known):
            foreign = sorted(there - (known or set()))
            raise OutputError(
                "output-unwritable",
                f"replacing `{hide(address)}` would delete files that mjcompose did not write: `{foreign[0]}`",
                "move them elsewhere, or choose another address",
            )
        new = {
            each.relative_to(folder).as_posix(): each for each in folder.rglob("*") if os.path.isfile(each)
        }
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
            at, content = f"{path}/{file.name}", read_regular(file, is_source=False)
            if not (fs.exists(at) and fs.info(at)["size"] == len(content)):
                _put(fs, at, content)


def manifest_at(address: str) -> bytes:
    """Return the manifest of a bundle at an address. Raises OSError and the exceptions of `zipfile`."""
    try:
        with opened(address) as (fs, path):
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
        with opened(address) as (fs, path):
            found = fs.find(path, detail=True) if fs.isdir(path) else {path: fs.info(path)}
    except RemoteError:
        return []
    return [[name, about.get("size"), _state(about)] for name, about in sorted(found.items())]


def download(address: str, folder: Path, files: int, size: int) -> Path:
    """Download a bundle and the shared assets next to it to an empty folder; return its path there.

    Raises RemoteError, also for more than `files` files or `size` bytes.
    """
    name = PurePosixPath(address.rstrip("/")).name
    with opened(address) as (fs, path):
        if not fs.isdir(path):
            _check(fs.info(path)["size"], 1, files, most=size)
            fs.get_file(path, str(folder / name))
            return folder / name
        found = {each[len(path) + 1 :]: about["size"] for each, about in fs.find(path, detail=True).items()}
        _check(sum(found.values()), len(found), files, most=size)
        above = path
        for each in sorted(found):
            _fetch(fs, f"{path}/{each}", folder / "models" / name, inside=each)
        beside = [each for each in _listed(fs, f"{path}/{MANIFEST}") or () if each.startswith("../")]
        for each in beside:
            up = each.count("../")
            above, inside = path, each.removeprefix("../" * up)
            for _ in range(up):
                above = above.rpartition("/")[0]
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


def _listed(fs: FileSystem, path: str) -> set[str] | None:
    """Return the files in a manifest, including the manifest, or None if it is not a manifest."""
    import json

    try:
        manifest = json.loads(fs.cat_file(path))
        return {MANIFEST, *(str(each["path"]) for each in manifest["files"])}
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return None


def _state(about: dict[str, Any]) -> str:
    return str(next((about[key] for key in ("ETag", "etag", "md5", "mtime", "created") if key in about), ""))
