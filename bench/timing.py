"""Times that can be compared: candidates take turns, the best of many rounds counts, nothing is collected."""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Callable, Mapping

Candidate = Callable[[], object]
Clock = Callable[[], float]


def best_times(
    candidates: Mapping[str, Candidate], *, rounds: int, seconds: float, clock: Clock = time.perf_counter
) -> dict[str, float]:
    """The shortest time of each in seconds; ends after `rounds` or `seconds`, not before the third."""
    best = dict.fromkeys(candidates, float("inf"))
    end = time.perf_counter() + seconds
    for done in range(rounds):
        if done >= 3 and time.perf_counter() > end:
            break
        for name, candidate in candidates.items():
            best[name] = min(best[name], _once(candidate, clock))
    return best


def processor_time() -> float:
    """Of all processes that have been run: other work on the machine adds less to it than to the time on the wall."""
    if sys.platform == "win32":
        return time.perf_counter()
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _once(candidate: Candidate, clock: Clock) -> float:
    collecting = gc.isenabled()
    gc.collect(0)
    gc.disable()
    try:
        start = clock()
        kept = candidate()
        taken = clock() - start
    finally:
        if collecting:
            gc.enable()
    del kept
    return taken
