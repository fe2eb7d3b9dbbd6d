"""Files on disk so that MuJoCo's cache of assets serves again, and never gives what belongs to another file.

The cache trusts path and time of change. Here a content always has the same time, another content another one.
"""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path


@cache
def _store(process: int) -> Path:
    folder = Path(tempfile.mkdtemp(prefix=f"fidelity-{process}-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def folder(name: str, files: Mapping[str, bytes]) -> Path:
    """A folder of this process with exactly these files; what an earlier call put there is gone."""
    store = _store(os.getpid())
    place = store / name
    shutil.rmtree(place, ignore_errors=True)
    (store / "contents").mkdir(exist_ok=True)
    for path, content in files.items():
        digest = hashlib.sha256(content).hexdigest()
        kept = store / "contents" / digest
        if not kept.exists():
            kept.write_bytes(content)
            time = 10**9 + int(digest[:7], 16)
            os.utime(kept, (time, time))
        target = place / path
        target.parent.mkdir(parents=True, exist_ok=True)
        try:
            os.link(kept, target)
        except OSError:
            shutil.copy2(kept, target)
    return place
