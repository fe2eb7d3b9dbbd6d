from __future__ import annotations

import mujoco
import pytest
from mjcompose.model.grammar import GRAMMAR
from mjcompose.mujoco.attributes import TAGS, array_of, attributes

from tests.build.checks.conftest import notes

MODEL = """
<mujoco>
  <worldbody>
    <light name="lamp" cutoff="30"/><camera name="eye" fovy="60"/>
    <body name="b" pos="0 0 1">
      <joint name="hinge" range="-90 180" damping="3" ref="30"/><geom name="g" size=".1" friction="1 .2 .3" rgba=".1 .2 .3 1"/>
      <body name="c"><joint name="slide" type="slide" range="-1 2"/><geom name="h" size=".1" friction=".5"/></body>
    </body>
  </worldbody>
  <sensor><jointpos name="turn" joint="hinge" cutoff="1.5707963267948966"/></sensor>
  <actuator><position name="a" joint="hinge" kp="7" ctrlrange="-1 1"/><position name="p" joint="slide" ctrlrange="-2 2"/></actuator>
</mujoco>
"""


@pytest.mark.parametrize(
    "check",
    [
        "joint: hinge, attr: damping, value: 3",
        'joint: hinge, attr: "range[1]", value: 180deg, tol: 1e-6',
        "joint: hinge, attr: range, value: [-90deg, 180deg]",
        "joint: hinge, attr: range, value: [-1.57rad, 3.14rad], tol: 0.1deg",
        "joint: slide, attr: range, value: [-1, 2]",
        "joint: hinge, attr: ref, value: 30deg",
        "joint: hinge, attr: limited, value: true",
        "joint: hinge, attr: axis, value: [0, 0, 1]",
        "geom: g, attr: rgba, value: [0.1, 0.2, 0.3, 1]",
        'geom: "*", attr: condim, value: 3',
        "camera: eye, attr: fovy, value: 60deg",
        "camera: eye, attr: fovy, value: 1.0471975512rad",
        "light: lamp, attr: cutoff, value: 30",
        "light: lamp, attr: cutoff, value: 30deg",
        "sensor: turn, attr: cutoff, value: 90deg",
        'actuator: a, attr: "gainprm[0]", value: 7',
        "actuator: p, attr: ctrlrange, value: [-2, 2]",
        "body: b, attr: pos, value: [0, 0, 1]",
    ],
)
def test_holds(ask, check: str) -> None:
    assert ask(MODEL, f"equal: {{{check}}}") == []


@pytest.mark.parametrize(
    ("check", "message"),
    [
        ("joint: hinge, attr: damping, value: 3.00001", "`damping` of joint `hinge` is 3, not 3.00001"),
        (
            'joint: hinge, attr: "range[1]", value: 170deg',
            "`range[1]` of joint `hinge` is 180deg, not 170deg",
        ),
        ("joint: hinge, attr: limited, value: false", "`limited` of joint `hinge` is true, not false"),
        (
            "geom: g, attr: friction, value: [1, 0.2, 0.4], tol: 0.05",
            "`friction` of geom `g` is [1, 0.2, 0.3], not [1, 0.2, 0.4] ± 0.05",
        ),
        ('geom: "*", attr: "friction[0]", value: 1', "`friction[0]` of geom `h` is 0.5, not 1"),
    ],
)
def test_does_not_hold(ask, check: str, message: str) -> None:
    (finding,) = ask(MODEL, f"equal: {{{check}}}")
    assert (finding.message, finding.at, finding.code) == (message, ("value",), "check-failed")
    assert [note.partition(":")[0] for note in notes(finding)] == ["expected", "actual"]


@pytest.mark.parametrize(
    ("check", "code", "at"),
    [
        ("joint: hing, attr: damping, value: 3", "unknown-name", "joint"),
        ("joint: hinge, attr: range, value: 3deg", "wrong-length", "value"),
        ('joint: hinge, attr: "range[2]", value: 3deg', "wrong-length", "attr"),
        ('joint: hinge, attr: "range[1]", value: 3', "bare-angle", "value"),
    ],
)
def test_what_makes_no_sense_of_this_model(ask, check: str, code: str, at: str) -> None:
    (finding,) = ask(MODEL, f"equal: {{{check}}}")
    assert (finding.code, finding.at) == (code, (at,))


def test_bare_angles_have_the_unit_of_the_recipe(ask) -> None:
    assert ask(MODEL, 'equal: {joint: hinge, attr: "range[1]", value: 180}', head="angle: degree") == []
    assert (
        ask(MODEL, 'equal: {joint: hinge, attr: "range[1]", value: 3.14159265359}', head="angle: radian")
        == []
    )
    assert ask(MODEL, 'equal: {joint: slide, attr: "range[1]", value: 2}', head="angle: degree") == []


def test_names_in_a_nested_recipe(ask) -> None:
    nested = MODEL.replace('name="', 'name="left/').replace('joint="', 'joint="left/')
    assert ask(nested, "equal: {joint: hinge, attr: damping, value: 3}", prefix="left/") == []


def test_every_attribute_is_one_of_mjcf_and_has_an_array() -> None:
    model = mujoco.MjModel.from_xml_string(MODEL)
    tags = {"pair": "contact/pair", "key": "keyframe/key", "equality": "equality/weld", "tendon": "tendon/spatial",
            "actuator": "actuator/general", "sensor": "sensor/user", "material": "asset/material"}  # fmt: skip
    of_others = {"diaginertia": "inertial", "mass": "inertial"}
    for tag in TAGS:
        for name in attributes(tag):
            path = of_others.get(name, tags.get(tag, tag)) if tag == "body" else tags.get(tag, tag)
            assert name in GRAMMAR.element(path).attributes, (tag, name)
            assert hasattr(model, array_of(tag, name)), (tag, name)


def test_rows_of_controls_and_outputs_are_not_those_of_actuators(ask) -> None:
    if not hasattr(mujoco.mjtGain, "mjGAIN_SO3"):
        pytest.skip("this MuJoCo has no actuator with several outputs")
    model = """<mujoco><worldbody><body><joint name="b" type="ball"/><geom size=".1"/>
      <body><joint name="j"/><geom size=".1"/></body></body></worldbody>
      <actuator><orientation name="o" joint="b" kp="2"/><position name="p" joint="j" gear="2" ctrlrange="-1 1"/></actuator>
    </mujoco>"""
    assert ask(model, 'equal: {actuator: p, attr: "gear[0]", value: 2}') == []
    assert ask(model, "equal: {actuator: p, attr: ctrlrange, value: [-1, 1]}") == []
