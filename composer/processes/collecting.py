"""How often Python's garbage collector runs in processes of this project."""

from __future__ import annotations

import gc

_NEW, _YOUNG, _OLD = 50_000, 20, 50


def rarely_collecting() -> None:
    """Run the garbage collector less often: imports and models create many objects that stay.

    A cold build takes a little less time and no more memory.
    """
    gc.set_threshold(_NEW, _YOUNG, _OLD)
