"""A file of measurements is refused if it was measured with another model, and only then."""

from __future__ import annotations

from pathlib import Path

import mujoco
import pytest
from mjcompose.mujoco.fingerprint import fingerprints
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context

ARM = """<mujoco model="arm">
  <option timestep="{step}"/>
  <worldbody><body name="base"{base}>{more}<geom size=".1"/>
    <body name="upper" pos="0 0 .1"><joint name="pan" damping="{damping}"/><geom size=".1" mass="{mass}"/>
      <body pos="0 {y} .3"><joint name="elbow" axis="0 1 0" range="-1 {range}"/><geom size=".1" mass="1"/></body></body></body>
  </worldbody>
  <actuator><position name="pan" joint="pan" kp="{kp}"/></actuator>
</mujoco>"""
PLAIN = {"step": 0.002, "base": "", "more": "", "damping": 1, "mass": 2, "y": 0, "range": 1, "kp": 10}
NUMBERS = [
    {"kind": "joint", "names": ["pan"], "attribute": "damping"},
    {"kind": "actuator", "names": ["pan"], "attribute": "kp"},
]
CAMERA = '<camera pos="0 0 1"/></body><body name="mug"><freejoint/><geom size=".02"/></body><body name="more">'


def topics(**changes: object) -> dict[str, str]:
    model = mujoco.MjModel.from_xml_string(ARM.format(**{**PLAIN, **changes}))
    found: dict[str, str] = fingerprints(mujoco, model, {"prefix": "", "numbers": NUMBERS})["topics"]
    return found


@pytest.mark.parametrize(
    ("changes", "changed"),
    [
        ({"more": CAMERA}, []),
        ({"base": ' pos="1 2 3" euler="90 0 0"'}, []),
        ({"damping": 3, "kp": 25, "range": 0.5}, []),
        ({"mass": 2.02}, ["inertia"]),
        ({"y": 0.001}, ["links"]),
        ({"step": 0.001}, ["options"]),
    ],
)
def test_what_changes_a_hash(changes: dict[str, object], changed: list[str]) -> None:
    before = topics()
    after = topics(**changes)
    assert [topic for topic in before if before[topic] != after[topic]] == changed


def test_numbers_that_were_not_measured_count() -> None:
    text = ARM.format(**PLAIN).replace('axis="0 1 0"', 'axis="0 1 0" damping="0.5"')
    model = mujoco.MjModel.from_xml_string(text)
    after = fingerprints(mujoco, model, {"prefix": "", "numbers": NUMBERS})["topics"]
    assert [topic for topic, known in topics().items() if after[topic] != known] == ["friction"]


def laid(folder: Path, recipe: str, **changes: object) -> list[str]:
    (folder / "arm.xml").write_text(ARM.format(**{**PLAIN, **changes}))
    hashes = ", ".join(f'{topic}: "{known}"' for topic, known in topics().items())
    (folder / "A12.yaml").write_text(
        f"measured: 1\nrecipe: {{{hashes}}}\nvalues:\n"
        "  joint pan: {damping: {value: 0.7}}\n  actuator pan: {kp: {value: 12}}\n"
    )
    robot = "recipe: 1\nallow: [license-missing]\nbase: ./arm.xml\nmeasured: A12.yaml\n"
    (folder / "robot.yaml").write_text(robot)
    (folder / "recipe.yaml").write_text(recipe)
    context = Context(folder=folder)
    build(ModelRequest(folder / "recipe.yaml"), context)
    return [each.message for each in context.sink.errors]


ALONE = "recipe: 1\nallow: [license-missing]\nextends: ./robot.yaml\n"
IN_A_CELL = """recipe: 1
allow: [license-missing]
add: [{to: world, body: {name: table, pos: [1, 0, 0], geom: {size: [0.2]}, site: {name: mount}}}]
attach: {left: {model: ./robot.yaml, site: mount}, right: {model: ./robot.yaml}}
"""


@pytest.mark.parametrize("recipe", [ALONE, IN_A_CELL])
def test_a_build_with_the_model_that_was_measured(recipe: str, tmp_path: Path) -> None:
    assert laid(tmp_path, recipe) == []


@pytest.mark.parametrize("recipe", [ALONE, IN_A_CELL])
def test_a_build_with_another_model(recipe: str, tmp_path: Path) -> None:
    message = "`A12.yaml` was measured with other inertia than this recipe has"
    assert set(laid(tmp_path, recipe, mass=2.02)) == {message}


def test_samples_differ_on_purpose(tmp_path: Path) -> None:
    drawn = (
        ALONE
        + "randomize: {seed: 1, samples: 2, fields: {m: {select: {body: upper}, attr: mass, scale: {uniform: [2, 3]}}}}\n"
    )
    assert laid(tmp_path, drawn) == []
    assert build(ModelRequest(tmp_path / "recipe.yaml", sample=1), Context(folder=tmp_path)) is not None


def test_a_stale_file_can_be_accepted(tmp_path: Path) -> None:
    accepted = ALONE + "measured: {file: A12.yaml, stale: accept}\n"
    assert laid(tmp_path, accepted, mass=2.02) == []
