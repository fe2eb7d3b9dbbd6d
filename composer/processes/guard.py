"""Ends a process when the one that started it is gone: `python guard.py LIFE PARENT MEMORY SIZE COMMAND…`.

`LIFE` is the reading end of a pipe whose other end only the parent has. A fork of this process watches it, for the
process itself may be in the middle of anything: MuJoCo holds Python's lock while it compiles, so no thread would do.
A death signal (`PR_SET_PDEATHSIG`) is Linux's alone, and comes when the parent's thread ends.

Run by its path with nothing else to import, for each command that is started waits for it.
"""

import contextlib
import os
import select
import signal
import sys

_LOOK_AGAIN = 200  # milliseconds
_MOST_FILES = 4096


def end_with(life: int, parent: int) -> None:
    """From now on this process and its group are killed when the process `parent` ends, or closes `life`."""
    me = os.getpid()
    if os.fork():
        os.close(life)
        return
    os.closerange(0, life)  # who reads what the process says must see it end
    os.closerange(life + 1, _MOST_FILES)
    ends = select.poll()
    ends.register(life, 0)  # that the other end is closed is always reported
    if hasattr(os, "pidfd_open"):
        # The pipe's other end may have been inherited by a fork of the parent.
        # Where it has ended already, the pipe says so.
        with contextlib.suppress(OSError):
            ends.register(os.pidfd_open(parent), select.POLLIN)
    while os.getppid() == me:
        if ends.poll(_LOOK_AGAIN):
            if os.getppid() == me:
                os.killpg(me, signal.SIGKILL)
            break
    os._exit(0)


def limit(memory: int, size: int) -> None:
    """What this process may take: bytes of data, and of each file that it writes; 0 means no limit."""
    import resource

    for kind, value in ((resource.RLIMIT_DATA, memory), (resource.RLIMIT_FSIZE, size)):
        hard = resource.getrlimit(kind)[1]
        if value:
            value = value if hard == resource.RLIM_INFINITY else min(value, hard)
            with contextlib.suppress(OSError, ValueError):  # a system that does not know this limit
                resource.setrlimit(kind, (value, hard))


if __name__ == "__main__":
    end_with(int(sys.argv[1]), int(sys.argv[2]))
    limit(int(sys.argv[3]), int(sys.argv[4]))
    os.execvp(sys.argv[5], sys.argv[5:])
