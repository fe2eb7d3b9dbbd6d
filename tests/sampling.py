"""Less work for tests of many models: some of a long list for `make test`, and models without their meshes."""

from __future__ import annotations

import shutil
import struct
from collections.abc import Callable, Collection, Iterable
from pathlib import Path
from typing import Any

import pytest


def rest_slow(values: Iterable[Any], quick: Collection[str], id: Callable[[Any], str] = str) -> list[Any]:
    """Parameters that are marked slow, but for those whose id is in `quick`; each of these must be a value's."""
    named = [(id(value), value) for value in values]
    unknown = set(quick) - {name for name, _ in named}
    assert not unknown or not named, f"no parameter is called {', '.join(sorted(unknown))}"
    return [
        pytest.param(value, id=name, marks=() if name in quick else pytest.mark.slow) for name, value in named
    ]


_CORNERS = ((0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))
_FACES = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
_OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in _CORNERS) + "".join(
    f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in _FACES
)
_STL = bytes(80) + struct.pack("<I", len(_FACES)) + b"".join(
    struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in _CORNERS[corner]), 0) for face in _FACES
)  # fmt: skip
_TETRAHEDRA = {".obj": _OBJ.encode(), ".stl": _STL}


def without_meshes(source: str, target: str) -> None:
    """Copies a file, and a mesh as a tetrahedron: for tests that compile many models and are not about meshes."""
    if (mesh := _TETRAHEDRA.get(Path(source).suffix.lower())) is None:
        shutil.copy(source, target)
    else:
        Path(target).write_bytes(mesh)
