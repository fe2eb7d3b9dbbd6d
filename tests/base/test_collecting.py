from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Iterator

import pytest
from mjcompose.base.runtime import rarely_collecting


@pytest.fixture(autouse=True)
def as_before() -> Iterator[None]:
    before = gc.get_threshold()
    called = list(gc.callbacks)
    yield
    gc.set_threshold(*before)
    gc.callbacks[:] = called


def test_the_first_collection_is_late_and_the_others_are_not() -> None:
    rarely_collecting()
    rarely_collecting()
    late, *others = gc.get_threshold()
    gc.collect(0)
    assert gc.get_threshold() == (50_000, *others)
    assert late > 500_000
    gc.collect(0)
    assert gc.get_threshold() == (50_000, *others)


def test_callbacks_of_others_are_called() -> None:
    called: list[str] = []
    gc.callbacks.insert(0, lambda phase, info: called.append(phase))
    rarely_collecting()
    gc.collect(0)
    assert called == ["start", "stop"]


def test_the_last_collection_has_nothing_to_look_at() -> None:
    program = (
        "import atexit, gc; from mjcompose.base.runtime import rarely_collecting; rarely_collecting();"
        "kept = [[] for _ in range(1000)]; atexit._run_exitfuncs(); print(gc.get_freeze_count(), gc.collect())"
    )
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout
    frozen, found = map(int, said.split())
    assert frozen > 1000 and found == 0
