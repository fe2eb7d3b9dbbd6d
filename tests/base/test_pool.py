"""Warm workers: the order of results, what becomes of a worker that dies, and that none outlives the pool."""

from __future__ import annotations

import os
import pickle
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import pytest
from mjcompose.base.processes import Died, Helper, Pool

ME = os.getpid()


@contextmanager
def opened(folder: Path) -> Iterator[Callable[[int], tuple[int, int]]]:
    """What a worker does with a number: it squares it, slowly, or dies of it."""
    yield partial(work, folder)


def work(folder: Path, number: int) -> tuple[int, int]:
    (folder / f"{number}-{os.getpid()}-{time.monotonic_ns()}").touch()
    time.sleep(0.02 * (number % 3))
    if number == 13 and os.getpid() != here():
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 5 and os.getpid() != here():
        raise ValueError("not in a worker")
    return number * number, os.getpid()


def here() -> int:
    return int(os.environ["POOL_TEST_PARENT"])


def begun(folder: Path, number: int) -> list[str]:
    return [name for name in os.listdir(folder) if name.startswith(f"{number}-")]


@pytest.fixture(autouse=True)
def parent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("POOL_TEST_PARENT", str(os.getpid()))


def busy(number: int) -> tuple[int, int]:
    """This process is to do nothing itself, but for what no worker can."""
    return number * number, os.getpid()


def slow(folder: Path, number: int) -> tuple[int, int]:
    time.sleep(0.1)
    return work(folder, number)


@pytest.mark.parametrize("workers", [0, 1, 3])
def test_results_come_in_the_order_of_the_tasks(workers: int, tmp_path: Path) -> None:
    numbers = [each for each in range(30) if each != 13]
    with Pool[int, tuple[int, int]](workers) as pool:
        found = list(pool.results(partial(opened, tmp_path), numbers, partial(slow, tmp_path)))
    assert [each[0] for each in found if not isinstance(each, Died)] == [each * each for each in numbers]
    processes = {each[1] for each in found if not isinstance(each, Died)}
    assert os.getpid() in processes and (len(processes) > 1) == (workers > 0)


def test_a_worker_that_dies_is_replaced_and_its_task_tried_once_more(tmp_path: Path) -> None:
    with Pool[int, tuple[int, int]](1) as pool:
        taken: list[object] = []
        taken += pool.results(partial(opened, tmp_path), [1, 13, 7, 2], partial(never_die, tmp_path))
    assert len(begun(tmp_path, 13)) == 2
    assert taken[1] == Died("ended with signal 9 (SIGKILL)")
    assert [each[0] for each in (taken[0], taken[2], taken[3])] == [1, 49, 4]  # type: ignore[index]


def never_die(folder: Path, number: int) -> tuple[int, int]:
    """The parent waits until the worker has begun what kills it."""
    for _ in range(500):
        if begun(folder, 13):
            break
        time.sleep(0.02)
    return number * number, os.getpid()


def test_what_raises_in_a_worker_raises_here(tmp_path: Path) -> None:
    def here_too(number: int) -> tuple[int, int]:
        if number == 5:
            raise KeyError("here")
        time.sleep(0.5)
        return busy(number)

    with Pool[int, tuple[int, int]](1) as pool, pytest.raises(KeyError, match="here"):
        list(pool.results(partial(opened, tmp_path), [1, 5, 2, 3], here_too))


def test_few_tasks_are_begun_before_a_result_is_taken(tmp_path: Path) -> None:
    taken = []

    def tasks() -> Iterator[int]:
        for number in range(1000):
            taken.append(number)
            yield number * 3  # which take no time

    with Pool[int, tuple[int, int]](1) as pool:
        results = pool.results(partial(opened, tmp_path), tasks(), busy)
        next(results)
        time.sleep(0.3)
        assert len(taken) <= 17


def test_no_worker_outlives_the_pool_and_what_is_done_is_handed_out(tmp_path: Path) -> None:
    with Pool[int, tuple[int, int]](2) as pool:
        results = pool.results(partial(opened, tmp_path), range(0, 90, 3), partial(slow, tmp_path))
        first = next(results)
        for _ in range(200):
            if len(os.listdir(tmp_path)) >= 6:
                break
            time.sleep(0.05)
        rest = list(pool.finished())
        processes = [each._process for each in pool._workers]
        assert rest and first[0] not in [each[0] for each in rest]  # type: ignore[index]
    assert not processes
    pids = {int(name.split("-")[1]) for name in os.listdir(tmp_path)} - {os.getpid()}
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)


def test_workers_start_without_the_module_path_of_the_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They get the module path of this process, which has dropped the folders that it must not search."""
    (tmp_path / "pickle.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    helper = Helper()
    try:
        square, worker = helper.result(pickle.dumps(partial(opened, tmp_path)), 3)
    finally:
        helper.end()
        helper.close()
    assert square == 9 and worker != os.getpid()
    assert not (tmp_path / "ran").exists()
