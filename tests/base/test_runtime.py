"""Signals that wait until what was begun is whole."""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from mjcompose.base import runtime as deferring_module
from mjcompose.base.processes import Pool
from mjcompose.base.runtime import (
    deferring,
    hear_signals,
    interruptible,
    patience,
    with_deferring,
    without_current_folder,
)

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals")


class Heard(Exception):
    """A signal came through."""


@pytest.fixture
def send() -> Iterator[Callable[[], None]]:
    def raise_heard(number: int, frame: object) -> None:
        raise Heard

    before = signal.signal(signal.SIGUSR1, with_deferring(raise_heard))
    yield lambda: signal.raise_signal(signal.SIGUSR1)
    signal.signal(signal.SIGUSR1, before)


def test_outside_of_blocks(send: Callable[[], None]) -> None:
    with pytest.raises(Heard):
        send()


def test_it_waits_to_the_end_of_the_block(send: Callable[[], None]) -> None:
    done = []
    with pytest.raises(Heard), deferring():
        send()
        done.append("all")
    assert done


def test_it_waits_for_an_interruptible_block(send: Callable[[], None]) -> None:
    with deferring():
        send()
        with pytest.raises(Heard), interruptible():
            pytest.fail("it is heard before the block")
        with pytest.raises(Heard), interruptible():
            send()
        hear_signals()
        send()
        with pytest.raises(Heard):
            hear_signals()


def test_the_second_does_not_wait(send: Callable[[], None]) -> None:
    with deferring():
        send()
        with pytest.raises(Heard):
            send()
        hear_signals()


def test_it_is_heard_after_an_error(send: Callable[[], None]) -> None:
    with pytest.raises(Heard), deferring():
        send()
        raise ValueError


def test_who_ends_is_waited_for_less_once_a_signal_has_come(
    send: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(deferring_module, "_heard", [])
    assert patience(5) == 5
    with pytest.raises(Heard):
        send()
    assert 0 < patience(5) <= 0.3 and patience(0.1) <= 0.1
    deferring_module._heard[0] -= 1
    assert patience(5) == 0


@contextmanager
def opened() -> Iterator[Callable[[int], int]]:
    """Ends its worker as soon as it has done the work, and not yet answered."""

    def work(number: int) -> int:
        os.kill(os.getpid(), signal.SIGTERM)
        return number + 1

    yield work


def test_a_worker_answers_for_what_it_has_done() -> None:
    with Pool[int, int](1) as pool:
        pool._opening = pickle.dumps(opened)
        for number in range(3):  # before each task it hears the signal, and another worker begins
            pool._todo.put((number, number))
        answers = [pool._done.get(timeout=30) for _ in range(3)]
    assert answers == [(0, 1), (1, 2), (2, 3)]


def test_modules_and_programs_are_found_in_absolute_folders_alone(tmp_path: Path) -> None:
    """Python has made the relative entries of PYTHONPATH absolute before this process can drop them."""
    for folder in ("here", "there"):
        (tmp_path / folder).mkdir()
    there = str(tmp_path / "there")
    script = (
        "import os, sys; from mjcompose.base.runtime import forget_current_folder; forget_current_folder();"
        "print([path for path in sys.path if not path or os.path.realpath(path).startswith(os.path.realpath('.'))],"
        "os.environ['PYTHONPATH'], os.environ['PYTHONSAFEPATH'], os.environ['PATH'])"
    )
    path = os.pathsep.join(["here", ".", "", there, "here"])
    environment = {**os.environ, "PYTHONPATH": path, "PATH": os.pathsep.join([".", os.defpath])}
    environment.pop("PYTHONSAFEPATH", None)
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [f"['{there}']", there, "1", os.defpath]


def test_a_program_without_a_path_does_not_search_the_current_folder() -> None:
    """A shell without `PATH` has a default of its own, which may have the current folder."""
    assert without_current_folder({"PATH": "bin", "HOME": "/root"}) == {"HOME": "/root", "PATH": os.defpath}
