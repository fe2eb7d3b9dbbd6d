"""The identity of the model that a table of worlds belongs to."""

from __future__ import annotations

import hashlib

from composer.bundle.bundle import DRAWS, WORLDS
from composer.bundle.manifest import Manifest

_TABLES = frozenset({DRAWS, WORLDS, "samples.csv"})


def model_sha256(manifest: Manifest) -> str:
    """Return the identity of a model: a hash of all files in its manifest, except tables of draws and worlds.

    That way a table can be in the bundle of its own model.
    """
    whole = hashlib.sha256()
    for file in sorted(manifest.files, key=lambda each: each.path):
        if file.path not in _TABLES:
            whole.update(f"{file.path}\0{file.sha256}\n".encode())
    return whole.hexdigest()
