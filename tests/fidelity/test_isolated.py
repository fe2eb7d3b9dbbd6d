"""Many things in a few processes, some of which go wrong."""

from __future__ import annotations

import os
import signal
import time

from fidelity.isolated import RECYCLED, each


def _work(number: int) -> str:
    if number == 3:
        raise ValueError("three")
    if number == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    if number == 7:
        time.sleep(60)
    return f"{number} in {os.getpid()}"


def test_every_argument_has_a_result_whatever_happens() -> None:
    results = list(each(_work, range(12), failed=lambda n, told: f"{n} failed {told}", workers=3, seconds=2))
    found = {int(result.split()[0]): result for result in results}
    assert sorted(found) == list(range(12))
    assert "ValueError: three" in found[3]
    assert "died with -9" in found[5]
    assert "took longer than 2 s" in found[7]
    assert sum("failed" in result for result in results) == 3
    assert str(os.getpid()) not in {result.split()[-1] for result in results}


def test_a_process_does_many_things_and_is_replaced() -> None:
    results = list(each(_work, range(100, 102 + RECYCLED), failed=lambda n, told: told, workers=1))
    processes = [result.split()[-1] for result in results]
    assert len(set(processes)) == 2
    assert processes == sorted(processes, key=processes.index)


def test_nothing_to_do() -> None:
    assert list(each(_work, [], failed=lambda n, told: told)) == []
