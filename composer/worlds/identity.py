"""Which model a table of worlds is of."""

from __future__ import annotations

import hashlib

from composer.bundle.bundle import DRAWS, WORLDS
from composer.bundle.manifest import Manifest

_TABLES = frozenset({DRAWS, WORLDS, "samples.csv"})


def model_sha256(manifest: Manifest) -> str:
    """The identity of a model: of all files that its manifest lists, tables of draws and worlds aside.

    So a table may stand in the bundle whose model it is of.
    """
    whole = hashlib.sha256()
    for file in sorted(manifest.files, key=lambda each: each.path):
        if file.path not in _TABLES:
            whole.update(f"{file.path}\0{file.sha256}\n".encode())
    return whole.hexdigest()
