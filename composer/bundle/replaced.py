"""What an output was made from, before another build replaces it."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from composer.bundle.bundle import MANIFEST
from composer.bundle.mjb import manifest_beside
from composer.dataclass import dataclass

_MAX = 64 << 20


@dataclass(frozen=True, slots=True)
class MadeOf:
    """The recipe of a model and its options; `values` are parameters, variants, the cell and the sample."""

    recipe: str
    values: Mapping[str, Any]

    def other_than(self, new: MadeOf) -> dict[str, Any]:
        """Return what differs from the new model: the recipe, or the old values.

        >>> MadeOf("a.yaml", {"x": 1, "y": 2}).other_than(MadeOf("a.yaml", {"x": 3, "y": 2}))
        {'x': 1}
        >>> MadeOf("a.yaml", {}).other_than(MadeOf("b.yaml", {}))
        {'recipe': 'a.yaml'}
        """
        if self.recipe != new.recipe:
            return {"recipe": self.recipe}
        return {
            name: value
            for name, value in self.values.items()
            if name in new.values and new.values[name] != value
        }


def made_of(out: Path | str) -> MadeOf | None:
    """Return what the manifest of an output says, or None if there is no readable one."""
    try:
        manifest = json.loads(_manifest(out))
        values = {**manifest["params"], **manifest["variants"]}
        if manifest["cell"] is not None:
            values["cell"] = manifest["cell"]
        if manifest["sample"] is not None:
            values["sample"] = manifest["sample"]
        return MadeOf(str(manifest["recipe"]["path"]), values)
    except (
        OSError,
        ValueError,
        KeyError,
        TypeError,
        RecursionError,
        NotImplementedError,
        zipfile.BadZipFile,
    ):
        return None  # any other file: `staged_file` decides whether it may be replaced


def _manifest(out: Path | str) -> bytes:
    if isinstance(out, str):
        from composer.bundle.remote import manifest_at

        return manifest_at(out)
    if os.path.isdir(out):
        return (out / MANIFEST).read_bytes()
    if out.suffix == ".mjb":
        return manifest_beside(out).read_bytes()
    with zipfile.ZipFile(out) as archive, archive.open(MANIFEST) as file:
        return file.read(_MAX)
