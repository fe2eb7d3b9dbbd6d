"""The packages that a build stands on."""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

PACKAGES = ("mujoco", "lxml", "numpy", "pydantic", "pyyaml")
"""What the bytes of a model, or the verdict on it, may depend on."""


def installed(names: tuple[str, ...]) -> Iterator[tuple[str, str, str]]:
    """Of each package that is installed: name, version, and a file that is another one in another version."""
    for name in names:
        try:
            found = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        folder = getattr(found, "_path", None)
        if folder is not None:
            yield name, found.version, str(Path(folder) / "METADATA")
