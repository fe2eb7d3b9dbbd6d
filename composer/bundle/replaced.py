"""What an output was made from, before another build replaces it."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from composer.bundle.bundle import LARGEST_MANIFEST, MANIFEST
from composer.bundle.mjb import manifest_beside
from composer.dataclass import dataclass
from composer.reading.regular import open_regular, read_regular


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
        return read_regular(out / MANIFEST, LARGEST_MANIFEST, is_source=False)
    if out.suffix == ".mjb":
        return read_regular(manifest_beside(out), LARGEST_MANIFEST, is_source=False)
    opened = open_regular(out, is_source=False)
    with opened as stream, zipfile.ZipFile(stream) as archive, archive.open(MANIFEST) as file:
        return file.read(LARGEST_MANIFEST)
