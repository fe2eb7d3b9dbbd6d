"""What a build depends on in its environment: this code, the interpreter, and variables that lead to models."""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
from typing import TYPE_CHECKING

from composer.sources import blobs
from composer.sources.kinds import KINDS
from composer.targets.names import CONSUMERS
from composer.version import __version__

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

_PACKAGE = os.path.dirname(os.path.dirname(os.path.realpath(__file__)))


def _stamp() -> str:
    """Return a hash of the sizes and times of the package's files, which is faster than reading them."""
    return hashlib.sha256(repr(list(_files())).encode()).hexdigest()


def tool_version(store: Path) -> str:
    """Return the version and a hash of all files of the package.

    In a checkout the code changes without the version. The hash is stored by the files' sizes and times.
    """
    stamp = _stamp()
    known = blobs.get(store, "asked", stamp)
    if known is not None:
        return known.decode()
    whole = hashlib.sha256()
    for path, *_ in _files():
        whole.update(os.path.relpath(path, _PACKAGE).encode())
        with open(path, "rb") as stream:
            whole.update(hashlib.sha256(stream.read()).digest())
    version = f"{__version__} ({whole.hexdigest()[:16]})"
    with contextlib.suppress(OSError):  # reported when a model is stored
        blobs.put(store, "asked", stamp, content=version.encode())
    return version


def python_version() -> str:
    """Return the version of the interpreter, and the place of its packages."""
    return f"{sys.version.split()[0]} in {sys.prefix}"


def environment_parts(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that decide which file a model reference stands for, or what reads a model back."""
    names = sorted({CONSUMERS, *(name for kind in KINDS for name in kind.variables)})
    return {f"the variable `{name}`": environment[name] for name in names if name in environment}


def _files() -> Iterator[tuple[str, int, int]]:
    """Yield path, size and time of each file that affects builds."""
    yield from _below(_PACKAGE)
    with contextlib.suppress(OSError):
        # The grammar's place in a checkout.
        yield _stamped(os.path.join(os.path.dirname(_PACKAGE), "schemas", "mjcf.json"))


def _below(folder: str) -> Iterator[tuple[str, int, int]]:
    try:
        entries = sorted(os.scandir(folder), key=lambda entry: entry.name)
    except OSError:
        return
    for entry in entries:
        if entry.is_dir():
            if entry.name != "__pycache__":
                yield from _below(entry.path)
        elif entry.name.endswith((".py", ".json", ".yaml")):
            yield _stamped(entry.path)


def _stamped(path: str) -> tuple[str, int, int]:
    status = os.stat(path)
    return path, status.st_size, status.st_mtime_ns
