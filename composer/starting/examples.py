"""The example recipes and their models, which the tutorial and the guides use."""

from __future__ import annotations

import os
from pathlib import Path

_SCHEMA_IN_CLONE = b"../schemas/recipe.schema.json"
_SCHEMA_BESIDE = b"recipe.schema.json"
_NOT_MODELS = ("README.md", "make_meshes.py")
"""What belongs to the repository: pages whose links lead into it, and the program that made the meshes."""


def examples(schema: str) -> dict[str, bytes]:
    """Return the files of the examples by path, with their licence; `schema` is the schema of recipes."""
    folder, licence = _places()
    paths = (
        path for path in sorted(folder.rglob("*")) if os.path.isfile(path) and path.name not in _NOT_MODELS
    )
    files = {path.relative_to(folder).as_posix(): _read(path) for path in paths if not _is_cached(path)}
    return {**files, "LICENSE": licence.read_bytes(), "recipe.schema.json": schema.encode()}


def _places() -> tuple[Path, Path]:
    """Return the folder and the licence: beside this file in an installed package, at the top of a clone."""
    beside = Path(__file__).with_name("examples")
    root = Path(__file__).parents[2]
    return (beside, beside / "LICENSE") if os.path.isdir(beside) else (root / "recipes", root / "LICENSE")


def _is_cached(path: Path) -> bool:
    return "__pycache__" in path.parts


def _read(path: Path) -> bytes:
    """Return the content. The schema of a recipe is beside it here, and a folder above in the repository."""
    content = path.read_bytes()
    return content.replace(_SCHEMA_IN_CLONE, _SCHEMA_BESIDE, 1) if path.suffix == ".yaml" else content
