from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest
from cases import Case
from mjcompose.compose.preview import preview_plan
from mjcompose.plan import read as read_module
from mjcompose.plan.describe import as_data, describe
from mjcompose.plan.plan import ExcludedPair, PlanPreview
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context

TESTS = Path(__file__).parents[1]


def foreseen(folder: Path) -> PlanPreview:
    context = Context(environment={}, folder=folder)
    plan = make_plan(Path("recipe.yaml"), context)
    assert plan is not None
    return preview_plan(plan, context)


def test_each_file_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read: list[str] = []
    parse = read_module.parse_file

    def counting(path: Path, *args: Any, **given: Any) -> Any:
        read.append(path.name)
        return parse(path, *args, **given)

    monkeypatch.setattr(read_module, "parse_file", counting)
    found = foreseen(shutil.copytree(TESTS / "golden" / "contacts_of_parts", tmp_path / "case"))
    assert sorted(read) == ["arm.xml", "cube.xml", "tool.xml"]
    assert ExcludedPair("upper", "stand/palm", "") in found.excluded


def test_of_a_source_that_is_not_mjcf_nothing_is_foreseen(tmp_path: Path) -> None:
    case = Case(TESTS / "errors" / "sources" / "source_not_mjcf.txt")
    found = foreseen(case.lay(tmp_path / "case"))
    assert (found.adopted, found.excluded) == ((), ())


GEARED = """<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body>
  <body><joint name="k" type="slide"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="m" joint="j" gear="50"/><position name="p" joint="k" kp="7" kv="2"/><motor joint="j"/>
  <velocity name="v" joint="j" gear="-2" kv="3"/></actuator></mujoco>"""


def test_gains_are_shown_as_joints_feel_them(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(GEARED)
    edit = "edit: [{select: {actuator: m}, convert: {to: position, kp: 300, kv: 4}, allow: [convert-loss]}]"
    (tmp_path / "recipe.yaml").write_text(f"recipe: 1\nbase: ./arm.xml\n{edit}\n")
    context = Context(environment={}, folder=tmp_path)
    plan = make_plan(Path("recipe.yaml"), context)
    assert plan is not None
    found = preview_plan(plan, context)
    text = describe(plan, found)
    assert "m: kp 300 N·m/rad, kv 4 N·m·s/rad through a gear of 50" in text
    assert "p: kp 7 N/m, kv 2 N·s/m" in text and "v: kv 12 N·m·s/rad through a gear of -2" in text
    assert [each["actuator"] for each in as_data(plan, found)["gains"]] == ["m", "p", "v"]
