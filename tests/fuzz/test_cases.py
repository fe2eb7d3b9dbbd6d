"""Every input that fuzzing has found, made small: nothing is wrong with it any more."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest
from fuzz.execution import wrong_with
from fuzz.mutation import ODD, ODD_TEXT, tree_changed
from fuzz.target import Tools, limits
from fuzz.targets.table import TARGETS
from mjcompose.mujoco.engine import Session

CASES = Path(__file__).parent / "cases"


@pytest.fixture(scope="module")
def tools() -> Iterator[Tools]:
    with Session(limits()) as session:
        yield Tools(session)


@pytest.mark.parametrize(
    "case", sorted(path for path in CASES.glob("*/*")), ids=lambda path: f"{path.parent.name}-{path.stem}"
)
def test_nothing_is_wrong_with_it(case: Path, tools: Tools) -> None:
    target = TARGETS[case.parent.name]
    assert case.suffix == target.suffix
    assert wrong_with(target, case.read_bytes(), None, tools) is None


@pytest.mark.parametrize("name", TARGETS)
def test_a_seed_is_well_and_what_breaks_is_seen(name: str, tools: Tools, monkeypatch: pytest.MonkeyPatch) -> None:
    target = TARGETS[name]
    seed = next(target.seeds(None))
    assert wrong_with(target, seed.data, seed.beside, tools) is None
    broken = type(target)(target.name, target.suffix, target.seeds, target.mutate, _breaks, target.beside)
    said = wrong_with(broken, seed.data, seed.beside, tools)
    assert said is not None and said.startswith("KeyError")


def _breaks(path: Path, tools: Tools) -> str | None:
    raise KeyError(path.name)


def test_what_is_put_in_is_text() -> None:
    assert len(set(ODD_TEXT)) > 50


def test_a_change_leaves_the_odd_values_as_they_are() -> None:
    random = Random(1)
    before = repr(ODD)
    for _ in range(400):
        tree_changed(tree_changed({"a": [1, {"b": 2}]}, random), random)
        assert repr(ODD) == before
