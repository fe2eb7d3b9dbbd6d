"""How often Python looks for what refers to itself and to nothing else, in a process of this project's own."""

from __future__ import annotations

import gc

_NEW, _YOUNG, _OLD = 50_000, 20, 50


def rarely_collecting() -> None:
    """Let Python look less often: imports and models make many objects that stay.

    A cold build takes a little less time for it, and no more memory.
    """
    gc.set_threshold(_NEW, _YOUNG, _OLD)
