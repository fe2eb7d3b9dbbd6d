from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any
from xml.etree import ElementTree

import mujoco
import pytest
from foreign import merging

ROBOT = """<mujoco model="robot"><compiler angle="radian" meshdir="meshes" autolimits="true"/><worldbody>
  <body name="hand"><joint name="turn" damping="0.2"/><geom size="0.1" mass="1"/>%s</body></worldbody>
  <actuator><motor name="motor" joint="turn"/></actuator></mujoco>"""
FINGER = '<body name="finger"><joint name="bend" range="0 1.5"/><geom size="0.1"/></body>'
GRIPPER = f"""<mujoco model="gripper"><option gravity="0 0 0"/><asset><texture name="skin" file="a.png"/>
  <texture name="skin" file="b.png"/></asset><worldbody>{FINGER}<geom name="pad" material="nowhere" size="1"/></worldbody></mujoco>"""


def _part(file: Path, text: str, **more: Any) -> SimpleNamespace:
    file.write_text(text, encoding="utf-8")
    root = ElementTree.fromstring(text)
    return SimpleNamespace(root=root, worldbody=root.find("worldbody"), file=str(file), **more)


@pytest.mark.parametrize(
    ("merged", "said"),
    [
        (FINGER, ""),
        (FINGER.replace("1.5", "1.6"), "joint `bend`: range is [0.  1.6] and [0.  1.5]"),
        (FINGER.replace("0.1", "0.2"), "body `finger`: mass is "),
    ],
)
def test_what_is_merged_is_compared_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, merged: str, said: str
) -> None:
    (tmp_path / "robot.xml").write_text(ROBOT % "")
    (tmp_path / "gripper.xml").write_text(f"<mujoco><worldbody>{FINGER}</worldbody></mujoco>")
    recipe = tmp_path / "recipe.yaml"
    recipe.write_text(
        "recipe: 1\nname: robot\nbase: ./robot.xml\nattach:\n  gripper:\n    model: ./gripper.xml\n    body: hand\n"
        "    prefix: ''\n    compiler: {angle: radian}\n"
    )
    model = mujoco.MjModel.from_xml_string(ROBOT % merged)
    monkeypatch.setattr(merging, "_merged", lambda *given: (model, recipe, {"turn": [0.5]}))
    verdict = merging.judge(merging.Merging("Arm", tmp_path))
    assert verdict.id == "robosuite/Arm" and verdict.said.startswith(said) and bool(said) == bool(verdict.said)


def test_what_robosuite_does_to_a_file_becomes_keys_of_the_recipe(tmp_path: Path) -> None:
    robot = _part(tmp_path / "robot.xml", ROBOT % "", _joints=["turn"])
    robot._elements = {"joints": [robot.root.find(".//joint")]}
    robot._elements["joints"][0].set("armature", "5.0")
    assert merging._settings(robot) == {"angle": "radian", "autolimits": True}
    assert merging._joint_edits(robot) == [{"select": {"joint": "turn"}, "set": {"armature": 5.0, "damping": 0.2}}]
    gripper = _part(tmp_path / "gripper.xml", GRIPPER, naming_prefix="gripper0_")
    assert merging._options(robot) == [] and merging._options(gripper) == ["option"]
    assert merging._repeated_assets(gripper) == [
        {"select": {"texture": "skin", "where": {"file": "b.png"}}, "remove": True}
    ]
    assert merging._materials(gripper) == []
    colored = gripper.root.find(".//geom[@name='pad']")
    colored.set("name", "gripper0_pad")
    del colored.attrib["material"]
    assert merging._materials(gripper) == [{"select": {"geom": "pad"}, "set": {"material": None}}]
