"""Ends a process when its parent is gone: `python guard.py LIFE PARENT MEMORY SIZE COMMAND…`.

`LIFE` is the reading end of a pipe whose other end only the parent has. A fork of this process watches it, because
the process itself may be busy: MuJoCo holds Python's lock while it compiles, so a thread would not work. A death
signal (`PR_SET_PDEATHSIG`) exists only on Linux, and is sent when the parent's thread ends.

The script is run by its path and imports nothing else, because every command that is started waits for it.
"""

import contextlib
import os
import select
import signal
import sys

_LOOK_AGAIN = 200  # milliseconds
_MOST_FILES = 4096


def end_with(life: int, parent: int) -> None:
    """Kill this process and its group when the process `parent` ends or closes `life`."""
    me = os.getpid()
    if os.fork():
        os.close(life)
        return
    os.closerange(0, life)  # readers of the process's output must see it end
    os.closerange(life + 1, _MOST_FILES)
    ends = select.poll()
    ends.register(life, 0)  # a closed other end is always reported
    if hasattr(os, "pidfd_open"):
        # A fork of the parent may have inherited the pipe's other end.
        with contextlib.suppress(OSError):
            ends.register(os.pidfd_open(parent), select.POLLIN)
    while os.getppid() == me:
        if ends.poll(_LOOK_AGAIN):
            if os.getppid() == me:
                os.killpg(me, signal.SIGKILL)
            break
    os._exit(0)


def limit(memory: int, size: int) -> None:
    """Limit the bytes of data of this process, and of each file that it writes; 0 means no limit."""
    import resource

    for kind, value in ((resource.RLIMIT_DATA, memory), (resource.RLIMIT_FSIZE, size)):
        hard = resource.getrlimit(kind)[1]
        if value:
            value = value if hard == resource.RLIM_INFINITY else min(value, hard)
            with contextlib.suppress(OSError, ValueError):  # a system without this limit
                resource.setrlimit(kind, (value, hard))


if __name__ == "__main__":
    end_with(int(sys.argv[1]), int(sys.argv[2]))
    limit(int(sys.argv[3]), int(sys.argv[4]))
    os.execvp(sys.argv[5], sys.argv[5:])
