"""Keys of the recipe outside of the ranges of the compiled model."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from mjcompose.base.diagnostic import Diagnostic
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

MODEL = """<mujoco><worldbody>
  <body><joint name="hip" type="ball" range="0 60"/><geom size=".1"/>
    <body pos="1 0 0"><joint name="knee" range="-30 90"/><geom size=".1"/>
      <body pos="1 0 0"><joint name="free_turn"/><joint name="rail" type="slide" range="0 .5"/><geom size=".1"/></body>
    </body></body>
  </worldbody>
  <actuator><position name="servo" joint="knee" kp="9" ctrlrange="-1 1"/>
    <general name="filter" joint="rail" dyntype="filter" actlimited="true" actrange="0 1"/></actuator></mujoco>"""


def warned(folder: Path, key: str) -> list[Diagnostic]:
    (folder / "m.xml").write_text(MODEL)
    (folder / "r.yaml").write_text(f"recipe: 1\nbase: ./m.xml\nkeyframe: {{k: {{{key}}}}}\n")
    context = Context(environment={}, folder=folder)
    assert build(ModelRequest(folder / "r.yaml"), context) is not None, context.sink.errors
    return [each for each in context.sink.diagnostics if each.code == "out-of-range"]


def turned(degrees: float, *axis: float) -> str:
    half = math.radians(degrees) / 2
    length = math.hypot(*axis)
    return str([math.cos(half), *(math.sin(half) * each / length for each in axis)])


@pytest.mark.parametrize(
    ("key", "message"),
    [
        (f"qpos: {{hip: {turned(59, 0, 0, 1)}}}", None),
        (f"qpos: {{hip: {turned(-59, 1, 1, 0)}}}", None),
        (f"qpos: {{hip: {turned(301, 0, 1, 0)}}}", None),  # 59 degrees the other way
        (
            f"qpos: {{hip: {turned(61, 1, 2, 3)}}}",
            "`qpos` of `hip` is 1.06465 rad, outside its range from 0 rad to 1.0472 rad",
        ),
        (f"qpos: {{hip: {turned(180, 0, 0, 1)}}}", "`qpos` of `hip` is 3.14159 rad,"),
        ("qpos: {knee: 90deg}", None),
        ("qpos: {knee: 91deg}", "`qpos` of `knee` is 91 deg, outside its range from -30 deg to 90 deg"),
        ("qpos: {knee: -0.53rad}", "`qpos` of `knee` is -0.53 rad, outside"),
        ("qpos: {free_turn: 900deg}", None),
        ("qpos: {rail: 0.51}", "`qpos` of `rail` is 0.51 m, outside its range from 0 m to 0.5 m"),
        ("ctrl: {servo: 1.5rad}", "`ctrl` of `servo` is 1.5 rad, outside its range from -1 rad to 1 rad"),
        ("act: {filter: 1.1}", "`act` of `filter` is 1.1"),
        ("act: {filter: 1}", None),
    ],
)
def test_a_number_outside_of_its_range_is_named(tmp_path: Path, key: str, message: str | None) -> None:
    found = warned(tmp_path, key)
    assert len(found) == (message is not None)
    if message is not None:
        assert found[0].message.startswith(message) and found[0].span is not None and found[0].span.line == 3
