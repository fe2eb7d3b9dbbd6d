from __future__ import annotations

from pathlib import Path

import pytest
from lint.workshop import check_case, linted
from mjcompose.mujoco.engine import Session

HINGE = '<mujoco>{}<worldbody><body><joint name="elbow" {}/><geom size="1"/></body></worldbody></mujoco>'
RADIAN = '<compiler angle="radian"/>'
MESH = """<mujoco><asset><mesh name="link" vertex="0 0 0 {0} 0 0 0 {0} 0 0 0 {0}"/></asset><worldbody>
  <body pos="0 0 .3"><joint/><geom type="mesh" mesh="link"/></body></worldbody></mujoco>"""


def option(text: str) -> str:
    return f"<mujoco><option {text}/></mujoco>"


def servo(angle: str, range: str, control: str) -> str:
    return f"""<mujoco><compiler angle="{angle}"/><worldbody><body><joint name="j" range="{range}"/><geom size="1"/></body>
      </worldbody><actuator><position name="p" joint="j" ctrlrange="{control}"/></actuator></mujoco>"""


CASES = [
    ("control-in-degrees", servo("radian", "-0.7 0.7", "0 40"), servo("radian", "-0.7 0.7", "0 20"), "57.1 times"),
    ("range-in-radians", HINGE.format("", 'range="-1.57 1.57"'), HINGE.format(RADIAN, 'range="-1.57 1.57"'), "degrees"),
    ("range-in-radians", HINGE.format("", 'range="0 3.1416"'), HINGE.format("", 'range="-2 2"'), "0 to 3.1416"),
    ("range-in-radians", HINGE.format("", 'range="0 1.0472"'), HINGE.format("", 'type="slide" range="0 1.0472"'), ""),
    ("range-in-degrees", HINGE.format(RADIAN, 'range="-90 90"'), HINGE.format("", 'range="-90 90"'), "-90 to 90 rad"),
    ("range-in-degrees", HINGE.format(RADIAN, 'range="0 45"'), HINGE.format(RADIAN, 'range="0 6.28"'), "joint `elbow`"),
    ("gravity-unit", option('gravity="0 0 -9810"'), option('gravity="0 0 -9.81"'), "1e+03 times"),
    ("timestep-extreme", option('timestep=".1"'), option('timestep=".01"'), "100 ms"),
    ("timestep-extreme", option('timestep="1e-6"'), option('timestep="1e-4"'), "0.001 ms"),
    ("mesh-in-millimeters", MESH.format(200), MESH.format(0.2), 'is 392 m from corner to corner'),
]  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_unit_is_found_and_a_near_model_is_not(
    case: tuple[str, str, str, str], tmp_path: Path, session: Session
) -> None:
    check_case(case, tmp_path, session)


def test_the_help_says_the_scale(tmp_path: Path, session: Session) -> None:
    (found,) = linted(MESH.format(200), "mesh-in-millimeters", tmp_path, session)
    assert found.help == 'if its file is in millimeters, write `scale="0.001 0.001 0.001"`'


@pytest.mark.parametrize(
    ("angle", "range", "control", "gear", "is_found"),
    [
        ("degree", "0 0.7", "0 0.7", "1", True),  # a fragment in radians
        ("degree", "0 40", "0 0.7", "1", False),
        ("radian", "0 40", "0 0.7", "1", True),
        ("radian", "0 0.7", "0 4000", "100", True),
        ("radian", "0 0.7", "0 40", "57.3", False),
        ("radian", "0 0.7", "0 49", "1", False),  # 70 times
    ],
)
def test_controls_and_ranges_in_two_units(
    angle: str, range: str, control: str, gear: str, is_found: bool, tmp_path: Path, session: Session
) -> None:
    text = servo(angle, range, control).replace("<position", f'<position gear="{gear}"')
    assert bool(linted(text, "control-in-degrees", tmp_path, session)) is is_found
