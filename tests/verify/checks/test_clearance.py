from __future__ import annotations

import mujoco
import pytest

from tests.verify.checks.conftest import notes

BALLS = """
<mujoco>
  {option}
  <worldbody>
    <body name="a/one"><freejoint/><geom name="a/ball" size=".1"/></body>
    <body name="a/two" pos=".15 0 0"><freejoint/><geom size=".1"/></body>
    <body name="b/three" pos="0 3 0"><freejoint/><geom size=".1"/></body>
  </worldbody>
  <keyframe>
    <key name="apart" qpos="0 0 0 1 0 0 0  1 0 0 1 0 0 0  2 0 0 1 0 0 0"/>
    <key name="heap" qpos="0 0 0 1 0 0 0  .19 0 0 1 0 0 0  0 .12 0 1 0 0 0"/>
  </keyframe>
</mujoco>
"""
MODEL = BALLS.format(option="")


def test_what_is_apart_holds(ask) -> None:
    assert ask(MODEL, "clearance: {key: apart}") == []
    assert ask(MODEL, "clearance: {min: -0.0501}") == []


def test_what_is_inside_of_something_does_not(ask) -> None:
    (finding,) = ask(MODEL, "clearance: {}")
    assert finding.message == "geom `a/ball` is 0.05 m inside of geom #0 of body `a/two`"
    assert notes(finding) == ("expected: at most 0.001 m inside", "actual: 0.05 m inside")


def test_the_deepest_is_told_first(ask) -> None:
    (finding,) = ask(MODEL, "clearance: {key: heap}")
    assert notes(finding)[1:] == (
        "actual: 0.08 m inside",
        "geom `a/ball` is 0.01 m inside of geom #0 of body `a/two` in `heap`",
    )


@pytest.mark.parametrize(
    ("pair", "holds"),
    [
        ("[a/ball, a/two]", True),
        ("[a/two, a/ball]", True),
        ('["a/**", "a/**"]', True),
        ('["**", "b/**"]', False),
        ("[a/one, a/one]", False),
    ],
)
def test_pairs_are_excluded_by_geom_or_body_in_either_order(ask, pair: str, holds: bool) -> None:
    assert (ask(MODEL, f"clearance: {{except: [{pair}]}}") == []) is holds


def test_in_a_nested_recipe_only_contacts_among_its_own_count(ask) -> None:
    (own,) = ask(MODEL, "clearance: {key: heap}", prefix="a/")
    assert notes(own)[1] == "actual: 0.01 m inside"
    assert ask(MODEL, "clearance: {key: heap}", prefix="b/") == []
    assert ask(MODEL, "clearance: {except: [[ball, two]]}", prefix="a/") == []


def test_options_that_switch_contacts_off_hide_nothing(ask) -> None:
    off = BALLS.format(option='<option><flag contact="disable"/></option>')
    assert len(ask(off, "clearance: {}")) == 1


def test_what_is_excluded_must_be_there(ask) -> None:
    (finding,) = ask(MODEL, 'clearance: {except: [["a/*", "/.*thre+/"], ["b/*", "c/**"]]}')
    assert (finding.code, finding.at) == ("unknown-name", ("except", 1, 1))
    assert finding.message == "`c/**` names no geom and no body and no flex"


@pytest.mark.parametrize("euler", ["3 5 0", "-3 5 0", "3 -5 0", "-3 -5 0"])
def test_of_the_contacts_of_a_pair_the_deepest_counts(ask, euler: str) -> None:
    """A tilted box is below the floor with its corners, each at another depth."""
    model = f"""<mujoco><worldbody><geom name="floor" type="plane" size="2 2 .1"/><body pos="0 0 .09" euler="{euler}">
      <freejoint/><geom name="box" type="box" size=".5 .3 .1"/></body></worldbody></mujoco>"""
    compiled = mujoco.MjModel.from_xml_string(model)
    mujoco.mj_forward(compiled, data := mujoco.MjData(compiled))
    depths = sorted(-contact.dist for contact in data.contact)
    (finding,) = ask(model, "clearance: {}")
    assert (
        len(depths) > 1
        and notes(finding)[1] == f"actual: {depths[-1]:.4g} m inside" != f"actual: {depths[-2]:.4g} m inside"
    )


def test_a_depth_that_is_hardly_too_much_is_shown_with_the_digits_that_differ(ask) -> None:
    (finding,) = ask(MODEL, "clearance: {min: -0.0499999}")
    assert finding.message.startswith("geom `a/ball` is 0.05 m inside")
    (finding,) = ask(MODEL.replace(".15 0 0", ".1499999 0 0"), "clearance: {min: -0.05}")
    assert notes(finding) == ("expected: at most 0.05 m inside", "actual: 0.0500001 m inside")


def test_a_distance_between_what_can_touch(ask) -> None:
    """Also where MuJoCo sees no contact: three is 2.8 m from one."""
    exclude = "except: [[a/ball, a/two]]"
    assert ask(MODEL, f"clearance: {{min: 2.7, {exclude}}}") == []
    (finding,) = ask(MODEL, f"clearance: {{min: 2.802, {exclude}}}")
    assert finding.message == "geom `a/ball` and geom #0 of body `b/three` are 2.8 m apart"
    assert notes(finding) == ("expected: at least 2.802 m", "actual: 2.8 m")


def test_two_sides(ask) -> None:
    assert ask(MODEL, 'clearance: {between: [a/one, "b/**"], min: 279cm}') == []
    (finding,) = ask(MODEL, 'clearance: {between: [a/one, "b/**"], min: 2.9}')
    assert finding.at == ("min",) and notes(finding)[1] == "actual: 2.8 m"
    assert ask(MODEL, 'clearance: {between: [a/one, "b/**"], min: 2.9, except: [[b/three, "**"]]}') == []
    (finding,) = ask(MODEL, "clearance: {between: [a/one, a/two]}")
    assert finding.message.startswith("geom `a/ball` is 0.05 m inside")
    assert ask(MODEL, "clearance: {between: [a/one, a/two], key: [apart]}") == []


def test_several_keyframes(ask) -> None:
    assert ask(MODEL, "clearance: {key: apart}") == []
    (finding,) = ask(MODEL, 'clearance: {key: "*"}')
    assert finding.message.endswith("in `heap`")
