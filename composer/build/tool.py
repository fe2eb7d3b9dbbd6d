"""What builds: this very code, and what it stands on."""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from composer.sources import blobs
from composer.version import __version__

_PACKAGE = Path(__file__).resolve().parents[1]
PACKAGES = ("mujoco", "lxml", "numpy", "pydantic", "pyyaml")
"""What the bytes of a model, or the verdict on it, may depend on."""


def tool_version(store: Path) -> str:
    """The version and a hash of all files of the package: in a checkout code changes and the version does not.

    The hash is kept in the store by the files' sizes and times, for reading all of them takes longer than to ask.
    """
    files = list(_files(str(_PACKAGE)))
    with contextlib.suppress(OSError):
        files.append(
            _stamped(str(_PACKAGE.parent / "schemas" / "mjcf.json"))
        )  # where a checkout has the grammar
    stamps = hashlib.sha256(repr([(path, *stamp) for path, *stamp in files]).encode()).hexdigest()
    known = blobs.get(store, "asked", stamps)
    if known is not None:
        return known.decode()
    whole = hashlib.sha256()
    for path, *_ in files:
        whole.update(os.path.relpath(path, _PACKAGE).encode())
        whole.update(hashlib.sha256(Path(path).read_bytes()).digest())
    version = f"{__version__} ({whole.hexdigest()[:16]})"
    with contextlib.suppress(OSError):  # told when a model is kept
        blobs.put(store, "asked", stamps, version.encode())
    return version


def python_version() -> str:
    """The interpreter, and where its packages are."""
    return f"{sys.version.split()[0]} in {sys.prefix}"


def installed(names: tuple[str, ...]) -> Iterator[tuple[str, str, str]]:
    """Of each package that is installed: name, version, and a file that is another one in another version."""
    from importlib import metadata

    for name in names:
        try:
            found = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        folder = getattr(found, "_path", None)
        if folder is not None:
            yield name, found.version, str(Path(folder) / "METADATA")


def _files(folder: str) -> Iterator[tuple[str, int, int]]:
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return
    for entry in entries:
        if entry.is_dir():
            if entry.name != "__pycache__":
                yield from _files(entry.path)
        elif entry.name.endswith((".py", ".json")):
            yield _stamped(entry.path)


def _stamped(path: str) -> tuple[str, int, int]:
    status = os.stat(path)
    return path, status.st_size, status.st_mtime_ns
