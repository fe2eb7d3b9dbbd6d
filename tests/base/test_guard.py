"""The guard by itself: what it holds open, and what it sees of the end of its parent."""

from __future__ import annotations

import os
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from mjcompose.base import guard

pytestmark = pytest.mark.skipif(os.name != "posix", reason="Windows has a job for it")
WITHOUT_PIDFD = (
    "import os, runpy, sys; vars(os).pop('pidfd_open', None); sys.argv = sys.argv[1:];"
    " runpy.run_path(sys.argv[0], run_name='__main__')"
)

# A shell knows no pipes above 9.
CLOSES = f"exec {sys.executable} -c 'import os, time; os.close(99); time.sleep(300)'"


@contextmanager
def guarded(
    script: str, *, more: tuple[int, ...] = (), pidfd: bool = True
) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """A shell script behind the guard, and the end of the pipe that keeps it alive."""
    life, held = os.pipe()
    begin = [sys.executable] if pidfd else [sys.executable, "-c", WITHOUT_PIDFD]
    process = subprocess.Popen(
        [*begin, str(Path(guard.__file__)), str(life), str(os.getpid()), "0", "0", "sh", "-c", script],
        stdout=subprocess.PIPE,
        pass_fds=(life, *more),
        start_new_session=True,
    )
    os.close(life)
    try:
        yield process, held
    finally:
        process.kill()
        process.wait()
        if process.stdout is not None:
            process.stdout.close()


def ends(reader: int, seconds: float = 20) -> bool:
    """Whether a pipe ends while whoever wrote to it still runs."""
    while select.select([reader], [], [], seconds)[0]:
        if not os.read(reader, 1000):
            return True
    return False


@pytest.mark.parametrize("pidfd", [True, False], ids=["pidfd", "no pidfd"])
def test_a_pipe_that_is_closed_is_the_end(pidfd: bool) -> None:
    """As on a system that cannot watch a process: macOS."""
    with guarded("echo ready; exec sleep 300", pidfd=pidfd) as (process, held):
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        os.close(held)
        assert process.wait(20) == -9


def test_who_reads_what_the_program_says_sees_it_end() -> None:
    with guarded("echo done; exec >&-; exec sleep 300") as (process, held):
        assert process.stdout is not None and ends(process.stdout.fileno())
        assert process.poll() is None
        os.close(held)


def test_other_pipes_that_the_program_was_given_end_too() -> None:
    reader, writer = os.pipe()
    os.dup2(writer, 99)
    try:
        with guarded(CLOSES, more=(99,)) as (process, held):
            os.close(99)
            os.close(writer)
            assert ends(reader)
            assert process.poll() is None
            os.close(held)
    finally:
        os.close(reader)
