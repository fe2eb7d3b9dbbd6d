"""How often Python's garbage collector runs in processes of this project."""

from __future__ import annotations

import atexit
import gc

_FIRST, _NEW, _YOUNG, _OLD = 700_000, 50_000, 20, 50


def rarely_collecting() -> None:
    """Run the garbage collector less often: imports and models create many objects that stay.

    A build of one model creates some 500,000 objects, of which 2,500 are garbage that a collection would find. It
    ends before the first collection, which saves it 40 ms of nine. Longer runs then collect as usual. Python
    collects once more before it ends, which takes another 100 ms, and has nothing to look at here.
    """
    gc.set_threshold(_FIRST, _YOUNG, _OLD)
    if _after_the_first not in gc.callbacks:
        gc.callbacks.append(_after_the_first)
        atexit.register(gc.freeze)


def _after_the_first(phase: str, info: dict[str, int]) -> None:
    gc.set_threshold(_NEW, _YOUNG, _OLD)
    gc.callbacks.remove(_after_the_first)
