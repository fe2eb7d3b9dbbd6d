from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from composer.compose import load
from composer.compose.foresee import foresee
from composer.context import Context
from composer.plan.foreseen import Excluded, Foreseen
from composer.plan.planner import make_plan

TESTS = Path(__file__).parents[1]


def foreseen(case: str, folder: Path) -> Foreseen:
    shutil.copytree(TESTS / case, folder / "case")
    context = Context(environment={}, folder=folder / "case")
    plan = make_plan(Path("recipe.yaml"), context)
    assert plan is not None
    return foresee(plan, context)


def test_each_file_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []
    parse = load.parse_file

    def counting(path: Path, *args: Any, **given: Any) -> Any:
        read.append(path.name)
        return parse(path, *args, **given)

    monkeypatch.setattr(load, "parse_file", counting)
    found = foreseen("golden/contacts_of_parts", tmp_path)
    assert sorted(read) == ["arm.xml", "cube.xml", "tool.xml"]
    assert Excluded("upper", "stand/palm", "") in found.excluded


def test_of_a_source_that_is_not_mjcf_nothing_is_foreseen(tmp_path: Path) -> None:
    found = foreseen("errors/source_not_mjcf", tmp_path)
    assert (found.adopted, found.excluded) == ((), ())
