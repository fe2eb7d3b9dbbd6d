"""The script that child processes run first, by its path; it ends them when their parent is gone.

`python guard.py LIFE PARENT MEMORY SIZE COMMAND…` runs a command, `python guard.py worker LIFE PARENT` does tasks.
`LIFE` is the read end of a pipe; only the parent has the write end. A fork of this process watches it, because
the process itself may be busy: MuJoCo holds Python's lock while it compiles, so a thread would not work. A death
signal (`PR_SET_PDEATHSIG`) exists only on Linux, and is sent when the parent's thread ends.

The script imports nothing else at its top, because every command that is started waits for it.
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


def work(life: int, parent: int) -> None:
    """Do the tasks on standard input, which only the parent writes, and answer whether each was done, with the result.

    The input has pickled objects: the module path with the modules to import, the opening, and tasks. Output of `print`
    goes to standard error.
    """
    import pickle
    from importlib import import_module

    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    if os.name == "posix":  # on Windows, a job object does it
        end_with(life, parent)
    sys.path[:], modules = pickle.load(sys.stdin.buffer)
    from mjcompose.base.runtime import deferring, interruptible, rarely_collecting, with_deferring

    signal.signal(signal.SIGTERM, with_deferring(lambda number, _: sys.exit(128 + number)))
    rarely_collecting()
    for each in modules:
        import_module(each)
    with contextlib.suppress(EOFError):
        opening = pickle.load(sys.stdin.buffer)
        with opening() as do, deferring():  # a task's output is always reported
            while True:
                with interruptible():
                    task = pickle.load(sys.stdin.buffer)
                try:
                    answer = pickle.dumps((True, do(task)))
                except Exception:  # the parent meets it when it does the task itself
                    answer = pickle.dumps((False, None))
                answers.write(answer)
                answers.flush()


if __name__ == "__main__":
    if sys.argv[1] == "worker":
        work(*map(int, sys.argv[2:]))
    else:
        end_with(int(sys.argv[1]), int(sys.argv[2]))
        limit(int(sys.argv[3]), int(sys.argv[4]))
        os.execvp(sys.argv[5], sys.argv[5:])
