"""Less work for tests of many models: some of a long list for `make test`, and models without their meshes."""

from __future__ import annotations

import re
import shutil
import struct
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest


def rest_slow(values: Iterable[Any], quick: Collection[str], id: Callable[[Any], str] = str) -> list[Any]:
    """Parameters that are marked slow, but for those whose id is in `quick`; each of these must be a value's."""
    named = [(id(value), value) for value in values]
    unknown = set(quick) - {name for name, _ in named}
    assert not unknown or not named, f"no parameter is called {', '.join(sorted(unknown))}"
    return [pytest.param(value, id=name, marks=() if name in quick else pytest.mark.slow) for name, value in named]


def need_robots(recipe: Path, folder: Path) -> None:
    """Skip a test of a recipe with a robot of Menagerie that is not in a folder."""
    for robot in re.findall(r"menagerie:(\w+)", recipe.read_text(encoding="utf-8")):
        if not (folder / robot).exists():
            pytest.skip(f"there is no {robot}")


_FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))


def _corners(mesh: Path) -> Any:
    """Four corners of the box around a mesh, float64 of shape (4, 3)."""
    data = mesh.read_bytes()
    if mesh.suffix.lower() == ".obj":
        points = np.array([line.split()[1:4] for line in data.splitlines() if line.startswith(b"v ")], float)
    else:
        facets = np.frombuffer(data, [("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("more", "<u2")], offset=84)
        points = facets["points"].reshape(-1, 3).astype(float)
    low = points.min(axis=0)
    high = points.max(axis=0)
    return np.where(np.vstack([np.zeros(3), np.eye(3)]) > 0, high, low)


def without_meshes(source: str, target: str) -> None:
    """Copies a file, and a mesh as a tetrahedron: for tests that compile many models and are not about meshes."""
    suffix = Path(source).suffix.lower()
    if suffix not in (".obj", ".stl"):
        shutil.copy(source, target)
        return
    corners = _corners(Path(source))
    if suffix == ".obj":
        lines = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in _FACES]
        Path(target).write_text("\n".join(lines) + "\n", encoding="utf-8")
    else:
        facets = (struct.pack("<12fH", 0, 0, 0, *corners[list(face)].ravel(), 0) for face in _FACES)
        Path(target).write_bytes(bytes(80) + struct.pack("<I", len(_FACES)) + b"".join(facets))
