"""Limit the memory of the command itself, and check it before a library fails in an obscure way."""

from __future__ import annotations

import contextlib
import os
import sys
from functools import cache

LEAST = 160 << 20
"""The least bytes of data for a build: OpenBLAS, a part of numpy, ends the process with less."""


def bound(memory: int) -> None:
    """Limit the data of this process to so many bytes, or to the user's limit if that is lower (POSIX)."""
    try:
        import resource
    except ImportError:
        return
    with contextlib.suppress(OSError, ValueError):  # a system without this limit
        allowed = [each for each in _given() if each != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_DATA, (min([memory, *allowed]), _given()[1]))


def ran_out() -> bool:
    """Return whether the process came near its limit: without memory, some C code raises SystemError (`re`, 3.11)."""
    try:
        import resource
    except ImportError:
        return False
    most = resource.getrlimit(resource.RLIMIT_DATA)[0]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return most != resource.RLIM_INFINITY and peak > most / 2


@cache
def _given() -> tuple[int, int]:
    """Return the user's limits, with which this process was started."""
    import resource

    return resource.getrlimit(resource.RLIMIT_DATA)


def too_little() -> str | None:
    """Return a message if the user allows less memory than any build needs; also make numpy need less."""
    # One thread for each core would take more memory than everything else, and numpy has little to do here.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        import resource
    except ImportError:
        return None
    for kind, option in ((resource.RLIMIT_DATA, "-d"), (resource.RLIMIT_AS, "-v")):
        soft = resource.getrlimit(kind)[0]
        if soft != resource.RLIM_INFINITY and soft < LEAST:
            return (
                f"not enough memory: this process may have {soft >> 20} MiB (`ulimit {option}`), and needs at least"
                f" {LEAST >> 20}"
            )
    return None
