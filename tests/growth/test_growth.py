"""Twice the input takes about twice the work: every command is counted with an input of two sizes.

Seconds differ from run to run, and counts do not. Loops in C are not seen: `make bench` measures those.
"""

from __future__ import annotations

import shutil
from pathlib import Path

import click
import pytest
from cli.shell import run
from click.testing import Result
from growth.cases import CASES, NOTHING_GROWS, Case
from growth.counting import answer_here, calls_of
from mjcompose.cli.main import main

MOST = 2.4
"""The calls for twice the input, divided by those for the input, without the calls that any input takes."""
_LEAST = 2


def _count(case: Case, size: int, folder: Path, monkeypatch: pytest.MonkeyPatch) -> int:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    monkeypatch.chdir(folder)
    words = case.write(size)
    results: list[Result] = []
    calls = calls_of(lambda: results.append(run(*words)))
    assert results[0].exit_code == case.exit_code, results[0].output + results[0].stderr
    return calls


def _growth(case: Case, least: int, once: int, twice: int) -> float:
    """Return by how much the calls grow if the input doubles; linear work gives 2."""
    each = (once - least) / (case.size - _LEAST)
    each_of_twice = (twice - least) / (2 * case.size - _LEAST)
    return 2 * each_of_twice / each


@pytest.mark.parametrize("name", CASES)
def test_twice_the_input_takes_twice_the_calls(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer_here(monkeypatch)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "cache"))
    case = CASES[name]
    folder = tmp_path / "input"
    _count(case, _LEAST, folder, monkeypatch)  # imports modules and fills what is kept for a whole process
    sizes = (_LEAST, case.size, 2 * case.size)
    least, once, twice = (_count(case, size, folder, monkeypatch) for size in sizes)
    assert once > least, "the work of this command does not grow with its input: the case is wrong"
    assert _growth(case, least, once, twice) <= MOST, (least, once, twice)


def test_every_command_has_a_case() -> None:
    commands = main.list_commands(click.Context(main))
    with_cases = {name.partition(":")[0] for name in CASES}
    assert with_cases.isdisjoint(NOTHING_GROWS)
    assert with_cases | NOTHING_GROWS.keys() == {
        name for name in commands if (command := main.get_command(click.Context(main), name)) and not command.hidden
    }


def test_work_that_grows_too_fast_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def nothing() -> None:
        pass

    def square(n: int) -> None:
        for _ in range(n * n):
            nothing()

    case = Case(lambda size: [], 20, exit_code=0)
    least, once, twice = (calls_of(lambda size=size: square(size)) for size in (_LEAST, 20, 40))
    assert _growth(case, least, once, twice) > MOST
