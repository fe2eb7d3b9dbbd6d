"""URDF: as the base of a recipe."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fuzz.mutation import xml_changed
from fuzz.target import ROOT, Seed, Target, Tools, error_cases
from fuzz.targets.model import differs

_LARGEST = 20_000
_ROBOT = b"""<robot name="r"><mujoco><compiler fusestatic="false"/></mujoco><material name="red"><color rgba="1 0 0 1"/></material>
  <link name="a"><inertial><origin xyz="0 0 1"/><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual><geometry><box size="1 1 1"/></geometry><material name="red"/></visual></link>
  <link name="b"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><geometry><sphere radius="1"/></geometry></collision></link>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 1" rpy="0 1 0"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><dynamics damping="1" friction="0"/></joint></robot>"""


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    yield Seed(_ROBOT)
    for path in [*sorted((ROOT / "tests").rglob("*.urdf")), *sorted(error_cases().rglob("*.urdf"))]:
        if path.stat().st_size < _LARGEST:
            yield Seed(path.read_bytes(), path.parent)


def check(path: Path, tools: Tools) -> str | None:
    return differs(path, tools, {"base": f"recipe: 1\nbase: ./{path.name}\n"})


TARGET = Target("urdf", ".urdf", _seeds, xml_changed, check)
