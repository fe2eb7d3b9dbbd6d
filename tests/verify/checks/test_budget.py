"""The check `budget`."""

from __future__ import annotations

import mujoco
import pytest
from mjcompose.language.checks.budget import Budget
from mjcompose.verify.checks.budget import check
from mjcompose.verify.checks.check import RecipeFacts, Scope

from tests.verify.checks.conftest import notes

MODEL = """<mujoco>
  <asset><mesh name="left/m" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/><mesh name="n" vertex="0 0 0 1 0 0 0 1 0 0 0 1"/>
    <texture name="left/t" type="2d" builtin="flat" width="4" height="8"/></asset>
  <worldbody><geom type="plane" size="1 1 1"/>
    <body name="left/ball" pos="0 0 1"><freejoint/><geom name="left/ball" size=".1"/></body>
    <body pos="0 0 3"><geom type="mesh" mesh="left/m"/><geom type="mesh" mesh="n"/></body></worldbody>
  <keyframe><key name="down" qpos="0 0 0 1 0 0 0"/><key name="up" qpos="0 0 1 1 0 0 0"/></keyframe>
</mujoco>"""


@pytest.mark.parametrize(
    ("asked", "prefix"),
    [
        ("faces: 8", ""),
        ("faces: 4", "left/"),
        ("textures: 96", ""),
        ("contacts: 1", ""),
        ("geoms: 4", ""),
        ("geoms: 1", "left/"),
        ("meshes: 1kB", ""),
        ("contacts: 0, key: up", ""),
        ("steps_per_second: 1", ""),
    ],
)
def test_holds(ask, asked: str, prefix: str) -> None:
    assert ask(MODEL, f"budget: {{{asked}}}", prefix=prefix) == []


@pytest.mark.parametrize(
    ("asked", "at", "told"),
    [
        ("faces: 7", "faces", "`faces` is 8, in all meshes together"),
        ("geoms: 3", "geoms", "`geoms` is 4"),
        ("meshes: 479", "meshes", "`meshes` is 480 bytes in memory"),
        ("textures: 95", "textures", "`textures` is 96 bytes in memory"),
        ("contacts: 0", "contacts", "`contacts` is 1, in `down`"),
        ("steps_per_second: 1e12", "steps_per_second", "one thread of this machine takes"),
    ],
)
def test_does_not_hold(ask, asked: str, at: str, told: str) -> None:
    (finding,) = ask(MODEL, f"budget: {{{asked}}}")
    assert (finding.code, finding.at) == ("check-failed", (at,)) and told in finding.message


def test_a_speed_is_called_a_measurement(ask) -> None:
    (finding,) = ask(MODEL, "budget: {steps_per_second: 1e12}")
    assert notes(finding)[2].startswith("that is a measurement of this machine")


def test_bytes_are_those_of_the_files() -> None:
    scope = Scope(mujoco, mujoco.MjModel.from_xml_string(MODEL), facts=RecipeFacts(size=1001))
    (finding,) = check(scope, Budget(bytes=1000))
    assert notes(finding) == ("expected: at most 1000", "actual: 1001")


def test_a_keyframe_that_is_not_there(ask) -> None:
    (finding,) = ask(MODEL, "budget: {contacts: 1, key: dwn}")
    assert (finding.code, finding.help) == ("unknown-name", "did you mean `down`?")
