"""A helper process: `python worker.py LIFE PARENT`, run by its path by `processes.py`.

It reads pickled objects from standard input, which only its parent writes: the module path with the modules to
import, the opening, and tasks. It answers each task with whether it could be done, and with the result. Output of
`print` goes to standard error.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
from collections.abc import Callable
from importlib import import_module
from typing import Any


def main() -> None:
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    sys.path[:], modules = pickle.load(sys.stdin.buffer)
    if os.name == "posix":  # on Windows, a job object does it
        from mjcompose.base.guard import end_with

        end_with(*map(int, sys.argv[1:]))
    from mjcompose.base.runtime import deferring, interruptible, rarely_collecting, with_deferring

    signal.signal(signal.SIGTERM, with_deferring(_end))
    rarely_collecting()
    for each in modules:
        import_module(each)
    with contextlib.suppress(EOFError):
        opening = pickle.load(sys.stdin.buffer)
        with opening() as do, deferring():  # a task's output is always reported
            while True:
                with interruptible():
                    task = pickle.load(sys.stdin.buffer)
                answers.write(_answer(do, task))
                answers.flush()


def _answer(do: Callable[[Any], Any], task: Any) -> bytes:
    try:
        return pickle.dumps((True, do(task)))
    except Exception:  # the parent meets it when it does the task itself
        return pickle.dumps((False, None))


def _end(signum: int, frame: object) -> None:
    sys.exit(128 + signum)


if __name__ == "__main__":
    main()
