"""The memory of the command itself: bounded, and looked at before a library fails in its own way."""

from __future__ import annotations

import contextlib
import os
import sys
from functools import cache

LEAST = 160 << 20
"""Bytes of data that a build needs at least: OpenBLAS, which numpy brings, ends the process where it gets less."""


def bound(memory: int) -> None:
    """Let this process have so many bytes of data, or as many as the user allows if that is less (POSIX)."""
    try:
        import resource
    except ImportError:
        return
    with contextlib.suppress(OSError, ValueError):  # a system that does not know this limit
        allowed = [each for each in _given() if each != resource.RLIM_INFINITY]
        resource.setrlimit(resource.RLIMIT_DATA, (min([memory, *allowed]), _given()[1]))


def ran_out() -> bool:
    """Whether the process came near to its limit: some C code that gets no memory raises SystemError (`re`, 3.11)."""
    try:
        import resource
    except ImportError:
        return False
    most = resource.getrlimit(resource.RLIMIT_DATA)[0]
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
    return most != resource.RLIM_INFINITY and peak > most / 2


@cache
def _given() -> tuple[int, int]:
    """What the user allows: the limits that this process was started with."""
    import resource

    return resource.getrlimit(resource.RLIMIT_DATA)


def too_little() -> str | None:
    """What to say where the user allows less memory than any build needs; also prepares numpy to need less."""
    # One thread for each core would cost more memory than all else, and numpy has little to do here.
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
