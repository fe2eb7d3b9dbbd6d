from __future__ import annotations

from pathlib import Path

import pytest
from mjcompose.plan import parts
from mjcompose.plan.describe import as_data, describe
from mjcompose.plan.plan import part_name
from mjcompose.plan.planner import make_plan
from mjcompose.sources.context import Context

ROBOT = '<mujoco model="robot"><worldbody><body name="base"/></worldbody></mujoco>'


def test_paths(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(ROBOT)
    (tmp_path / "arm.yaml").write_text("recipe: 1\nbase: ./robot.xml\nattach: {gripper: {model: ./robot.xml}}\n")
    (tmp_path / "cell.yaml").write_text(
        "recipe: 1\nattach:\n  left: {model: ./arm.yaml}\n  bare: {model: ./robot.xml, prefix: ''}\n"
        "  r: {model: ./robot.xml, prefix: right}\n  cube: {model: ./robot.xml, replicate: [{count: 2}]}\n"
    )
    plan = make_plan(Path("cell.yaml"), Context(environment={}, folder=tmp_path))
    assert plan is not None
    assert [part_name(part, "/") for part in plan.parts] == ["left", "bare", "right", "cube0", "cube1"]
    assert list(plan.part_names) == [
        "left",
        "left/base",
        "left/gripper",
        "bare",
        "right",
        "cube0",
        "cube1",
    ]


def test_places_of_a_walk(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(ROBOT)
    (tmp_path / "arm.yaml").write_text(
        "recipe: 1\nbase: ./robot.xml\nattach: {gripper: {model: ./robot.xml, keys: prefix}}\n"
    )
    (tmp_path / "cell.yaml").write_text(
        "recipe: 1\nbase: ./arm.yaml\nattach:\n"
        "  left: {model: ./arm.yaml, keys: prefix, body: base}\n"
        "  bare: {model: ./arm.yaml, prefix: '', drop: [key]}\n"
    )
    plan = make_plan(Path("cell.yaml"), Context(environment={}, folder=tmp_path))
    assert plan is not None
    places = {place.part: place for place in plan.walk()}
    assert {part: (each.prefix, each.keys, each.is_fixed_in_world) for part, each in places.items()} == {
        "": ("", "", True),
        "base": ("", "", True),
        "base/base": ("", "", True),
        "base/gripper": ("gripper/", "gripper/", True),
        "left": ("left/", "left/", False),
        "left/base": ("left/", "left/", False),
        "left/gripper": ("left/gripper/", "left/gripper/", False),
        "bare": ("", None, True),
        "bare/base": ("", None, True),
        "bare/gripper": ("gripper/", None, True),
    }
    assert places["base"].others == ("left/",)
    assert places["base/base"].others == ("left/", "gripper/")
    assert places["left/base"].others == ("left/gripper/",)
    assert places["left/gripper"].span == plan.parts[0].span
    assert [each.name for each in plan.plans()] == ["cell", "arm", "arm", "arm"]
    assert len(list(plan.sources())) == 6


def test_copies_are_described_once(tmp_path: Path) -> None:
    (tmp_path / "robot.xml").write_text(ROBOT)
    (tmp_path / "r.yaml").write_text(
        "recipe: 1\nattach: {peg: {model: ./robot.xml, replicate: [{count: 12}, {count: 2}]}}\nkeyframe: {home: {}}\n"
    )
    plan = make_plan(Path("r.yaml"), Context(environment={}, folder=tmp_path))
    assert plan is not None and len(plan.parts) == 24
    assert describe(plan).splitlines()[2:] == [
        "  attach peg00_0/ … peg11_1/ (12 × 2): ./robot.xml, in the world",
        "  write the keyframe home",
    ]
    assert len(as_data(plan)["parts"]) == 24


def faults_of(text: str, tmp_path: Path) -> list[str]:
    (tmp_path / "robot.xml").write_text(ROBOT)
    (tmp_path / "cell.yaml").write_text(text)
    context = Context(environment={}, folder=tmp_path)
    make_plan(Path("cell.yaml"), context)
    return [f"{fault.span.line}: {fault.code}" for fault in context.sink.errors if fault.span]


def test_a_fault_in_a_piece_that_is_left_out_is_found_whatever_other_pieces_write(tmp_path: Path) -> None:
    text = """\
recipe: 1
base: ./robot.xml
variants:
  plain: {off: {}, on: {option: {timestep: none}}}
  other: {off: {}, on: {option: {timestep: 0.001, gravity: [0, 0]}}}
  lists: {off: {}, on: {edit: [{select: {body: base}, set: {poss: 1}}]}}
  more: {off: {}, on: {edit: [{select: {body: base}, sett: {pos: [0, 0, 1]}}]}}
  whole: {off: {}, on: {option: 3}}
  removes: {off: {}, on: {attach: {a: {model: ./robot.xml, side: b}}}}
"""
    assert [fault.partition(":")[0] for fault in faults_of(text, tmp_path)] == ["4", "5", "6", "7", "8", "9"]


def test_pieces_of_many_axes_are_validated_in_a_few_rounds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    counted: list[int] = []
    validate = parts.validate_what_remains
    monkeypatch.setattr(parts, "validate_what_remains", lambda *given: counted.append(1) or validate(*given))
    edits = "[{select: {body: '**'}, set: {gravcomp: 1}}]"
    axis = f"  vNUMBER: {{a: {{}}, b: {{attach: {{pNUMBER: {{model: ./robot.xml}}}}}}, c: {{edit: {edits}}}}}\n"
    axes = "".join(axis.replace("NUMBER", str(number)) for number in range(20))
    assert faults_of(f"recipe: 1\nbase: ./robot.xml\nvariants:\n{axes}", tmp_path) == []
    assert len(counted) == 2


def test_rings_in_the_order_of_the_parts(tmp_path: Path) -> None:
    text = """\
recipe: 1
base: ./robot.xml
attach:
  tail: {model: ./robot.xml, body: b/base}
  a: {model: ./robot.xml, body: b/base}
  b: {model: ./robot.xml, body: c/base}
  c: {model: ./robot.xml, body: a/base}
  self: {model: ./robot.xml, body: self/base}
  ok: {model: ./robot.xml, body: base}
"""
    assert faults_of(text, tmp_path) == ["5: attach-cycle", "8: attach-cycle"]


def test_a_file_name_with_nul_is_no_traceback(tmp_path: Path) -> None:
    (tmp_path / "named.xml").write_bytes(b'<mujoco><include file="a\0b.xml"/></mujoco>')
    assert faults_of("recipe: 1\nbase: ./named.xml\n", tmp_path) == []
