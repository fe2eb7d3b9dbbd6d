"""Results of work on meshes, stored by content: next to the recipe for everybody, and in the store of this machine.

The key of a result is the hash of the mesh's bytes and attributes, the method and its settings. CoACD may give other
pieces on another machine or in another version, so a result next to the recipe counts; the lock pins its bytes.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
from dataclasses import field
from pathlib import Path
from typing import Any

from mjcompose.base.access import ALL
from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import MIB
from mjcompose.sources import blobs
from mjcompose.sources.context import Context
from mjcompose.sources.lock import shapes_folder
from mjcompose.sources.store import store_folder

FORMAT = 1
"""It changes when the same input must give another result."""
_MOST = 256 * MIB
_SHAPES = {
    "mesh": ("vertices", "faces"),
    **dict.fromkeys(("box", "sphere", "capsule", "cylinder"), ("size", "pos", "quat")),
}
_ERRORS = ("hausdorff", "beyond", "short", "uncovered", "volume", "samples")


def shapes_key(mesh: dict[str, str], method: str, wanted: Any) -> str:
    """Return the key of a result; `mesh` has the attributes, with the hash of a file's bytes. No I/O."""
    return blobs.key_of([FORMAT, sorted(mesh.items()), method, wanted])


@dataclass(slots=True)
class ShapeStore:
    """Finds and keeps results. `used` has the bytes of the requested results, by key."""

    context: Context
    used: dict[str, bytes] = field(default_factory=dict)

    def find(self, key: str, span: Span) -> dict[str, Any] | None:
        """Return the result of a key; None without a result, or if the file is broken, which is reported."""
        content = self._beside(key, span) or blobs.get(store_folder(self.context.environment), "shapes", key)
        if content is None:
            return None
        try:
            result = parse_shapes(json.loads(content))
        except (ValueError, RecursionError):
            path = self.path(key)
            message = f"`{self.context.shown(path) if path else key}` is not a collision shape that mjcompose made"
            help = "take it from version control, or remove it and run `mjcompose lock`"
            self.context.sink.error("lock-invalid", message, span, help=help)
            return None
        self.used[key] = content
        return result

    def keep(self, key: str, result: dict[str, Any]) -> None:
        """Put a result into the store of this machine."""
        content = (json.dumps(result, separators=(",", ":"), sort_keys=True, allow_nan=False) + "\n").encode()
        self.used[key] = content
        with contextlib.suppress(OSError):  # it is computed again the next time
            blobs.put(store_folder(self.context.environment), "shapes", key, content=content)

    def path(self, key: str) -> Path | None:
        fetching = self.context.fetching
        if fetching is None or fetching.lock_file is None:
            return None
        return shapes_folder(fetching.lock_file) / f"{key}.json"

    def _beside(self, key: str, span: Span) -> bytes | None:
        """Return the file next to the recipe, and report if it is not in the lock."""
        path, fetching = self.path(key), self.context.fetching
        if path is None or fetching is None:
            return None
        content = None
        try:
            content = ALL.read(path, _MOST)
        except (FileNotFoundError, NotADirectoryError):
            pass
        except Refused as refused:
            refused.report(self.context.sink, span, shown=self.context.shown)
        except OSError as error:
            message = f"`{self.context.shown(path)}` cannot be read: {(error.strerror or str(error)).lower()}"
            self.context.sink.error("file-unreadable", message, span)
        if fetching.lock is not None:
            self._compare(key, path, content, pinned=fetching.lock.shapes.get(key), span=span)
        return content

    def _compare(self, key: str, path: Path, content: bytes | None, pinned: str | None, span: Span) -> None:
        fetching = self.context.fetching
        assert fetching is not None
        shown = self.context.shown(path)
        lock = f"the lock `{self.context.shown(fetching.lock_file or path)}`"
        if pinned is None or content is None:
            if fetching.remakes_shapes:
                return
            message = f"{lock} has no entry for the shapes of the mesh"
            if pinned is not None:
                message = f"`{shown}`, which {lock} pins, does not exist"
            report = self.context.sink.error if fetching.locked else self.context.sink.warning
            help = f"run `mjcompose lock {fetching.recipe}` and commit the files that it writes"
            report("lock-stale", message, span, help=help)
        elif blobs.digest(content) != pinned:
            help = "take it from version control, or remove it and run `mjcompose lock`"
            self.context.sink.error("source-changed", f"`{shown}` differs from {lock}", span, help=help)


def parse_shapes(data: Any) -> dict[str, Any]:
    """Return the result if it is valid: somebody may have changed the file. Raises ValueError. No I/O."""
    if not isinstance(data, dict) or {*data} != {"shapes", "error", "mesh", "made_with"}:
        raise ValueError("no result")
    shapes, error, mesh = data["shapes"], data["error"], data["mesh"]
    if not isinstance(shapes, list) or not shapes or not all(map(_is_shape, shapes)):
        raise ValueError("no shapes")
    if not isinstance(error, dict) or {*error} != {*_ERRORS}:
        raise ValueError("no errors")
    if not all(value is None or _is_number(value) for value in error.values()):
        raise ValueError("no errors")
    if not isinstance(mesh, dict) or not isinstance(mesh.get("faces"), int) or not _is_number(mesh.get("size")):
        raise ValueError("no mesh")
    if not isinstance(data["made_with"], dict):
        raise ValueError("no versions")
    return data


def _is_shape(shape: Any) -> bool:
    if not isinstance(shape, dict) or shape.get("type") not in _SHAPES:
        return False
    wanted = _SHAPES[shape["type"]]
    if {*shape} != {"type", *wanted}:
        return False
    if shape["type"] != "mesh":
        widths = ((1, 3), (3, 3), (4, 4))
        return all(
            isinstance(shape[name], list) and low <= len(shape[name]) <= high and all(map(_is_number, shape[name]))
            for name, (low, high) in zip(wanted, widths, strict=True)
        )
    vertices, faces = shape["vertices"], shape["faces"]
    if not isinstance(vertices, list) or not isinstance(faces, list) or len(vertices) < 4 or len(faces) < 4:
        return False
    if not all(isinstance(each, list) and len(each) == 3 for each in (*vertices, *faces)):
        return False
    corners = (corner for face in faces for corner in face)
    return all(_is_number(value) for vertex in vertices for value in vertex) and all(
        type(corner) is int and 0 <= corner < len(vertices) for corner in corners
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def shapes_beside(folder: Path) -> dict[str, Path]:
    """Return the files of results in a folder next to a recipe, by key."""
    try:
        names = os.listdir(folder)
    except OSError:
        return {}
    return {
        name.removesuffix(".json"): folder / name
        for name in sorted(names)
        if name.endswith(".json") and len(name) == 69 and not name.strip("0123456789abcdef.json")
    }
