"""Where a user's store is."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping


def store_folder(environment: Mapping[str, str]) -> str:
    """The absolute path that `MJCOMPOSE_CACHE` names, or the place where the system keeps a user's caches."""
    if named := environment.get("MJCOMPOSE_CACHE"):
        return os.path.abspath(os.path.expanduser(named))
    if sys.platform == "linux" and "ANDROID_ROOT" not in environment:
        # What platformdirs says here too, which takes longer to import than a known model to be told.
        caches = environment.get("XDG_CACHE_HOME", "")
        return os.path.join(caches if caches.strip() else os.path.expanduser("~/.cache"), "mjcompose")
    from platformdirs import user_cache_dir

    return user_cache_dir("mjcompose", appauthor=False)
