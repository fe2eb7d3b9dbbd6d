from __future__ import annotations

import pytest

from tests.build.checks.conftest import notes


@pytest.mark.parametrize(
    ("selectors", "prefix"),
    [
        ('[{site: "**/tcp"}]', ""),
        ('[{site: "**/tcp"}, {key: home}, {actuator: "left/*"}]', ""),
        ('[{site: tcp}, {site: "**/tcp"}]', "left/"),
        ('[{body: "*/base", expect: 2}]', ""),
        ('[{geom: "**", expect: 6}, {geom: "*/*", expect: 2}]', ""),
        ('[{geom: "**", expect: 3}]', "left/"),
        ("[{mesh: any, expect: 0}]", ""),
        ('[{site: "**", in: {body: "*/base"}, expect: 1}, {geom: "**", in: {body: world}, expect: 6}]', ""),
        (
            '[{body: "**", parent: {body: base}, expect: 1}, {site: "**", in: {body: base}, expect: 1}]',
            "left/",
        ),
        ('[{joint: "**", parent: {body: "*/base"}, expect: 0}]', ""),
    ],
)
def test_holds(ask, arm: str, selectors: str, prefix: str) -> None:
    assert ask(arm, f"exists: {selectors}", prefix=prefix) == []


def test_keyframes_of_a_nested_recipe_are_called_as_its_policy_says(ask, arm: str) -> None:
    assert ask(arm, "exists: [{key: home}]", prefix="left/") == []
    assert ask(arm, "exists: [{key: low}]", prefix="left/", keys="left/") == []
    assert len(ask(arm, "exists: [{key: home}]", prefix="left/", keys=None)) == 1


def test_nothing_of_that_name(ask, arm: str) -> None:
    (finding,) = ask(arm, "exists: [{site: left/tcp}, {site: lft/tcp}]")
    assert finding.at == (1, "site")
    assert finding.message == "the site `lft/tcp` does not exist"
    assert notes(finding) == ("expected: at least one", "actual: 0", "sites that exist: left/tcp")
    assert finding.help == "did you mean `left/tcp`?"


def test_another_number(ask, arm: str) -> None:
    (finding,) = ask(arm, 'exists: [{body: "*/base", expect: 3}]')
    assert finding.message == "`*/base` names 2 elements `body`, not 3"
    assert notes(finding) == ("expected: 3", "actual: 2", "they are: left/base, right/base")


def test_what_is_of_another_part_is_not_found(ask, arm: str) -> None:
    (finding,) = ask(arm, "exists: [{body: base}, {site: tcp}]", prefix="right/")
    assert finding.at == (1, "site")


def test_nothing_of_that_name_there(ask, arm: str) -> None:
    (finding,) = ask(arm, 'exists: [{site: "**/tcp", in: {body: right/base}}]')
    assert finding.message == "the site `**/tcp` does not exist in a body `right/base`"


def test_only_what_has_the_values(ask, arm: str) -> None:
    assert ask(arm, 'exists: [{joint: "**", where: {"damping[0]": 100}, expect: 0}]') == []
    (finding,) = ask(arm, 'exists: [{joint: "**", where: {"damping[0]": 100}}]')
    assert finding.message.endswith("with such `damping[0]`")


WORDS = """
<mujoco>
  <asset><material name="steel"/></asset>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 1"/>
    <body name="a">
      <joint name="turn"/>
      <geom name="g" type="box" size=".1 .1 .1" material="steel"/>
      <site name="tip"/>
      <camera name="eye" mode="targetbody" target="b"/>
    </body>
    <body name="b" pos="1 0 0"><joint name="push" type="slide"/><geom name="h" size=".1"/></body>
  </worldbody>
  <contact><pair geom1="g" geom2="h"/><exclude body1="a" body2="b"/></contact>
  <equality><connect name="c" body1="a" body2="b" anchor="0 0 0"/><joint name="j" joint1="turn" joint2="push"/></equality>
  <actuator><position name="p" joint="turn" kp="1"/><motor name="m" site="tip" refsite="tip"/></actuator>
  <sensor>
    <framepos name="f" objtype="body" objname="a" reftype="site" refname="tip"/>
    <distance name="d" geom1="g" geom2="h" cutoff="1"/>
    <jointpos name="q" joint="push"/>
  </sensor>
</mujoco>
"""


@pytest.mark.parametrize(
    ("selector", "count"),
    [
        ('{geom: "**", where: {type: box}}', 1),
        ('{geom: "**", where: {type: box, material: steel, "size[0]": 0.1}}', 1),
        ('{geom: "**", where: {material: "*"}}', 1),
        ('{joint: "**", where: {type: slide}}', 1),
        ('{camera: "**", where: {mode: targetbody, target: b}}', 1),
        ('{camera: "**", where: {target: a}}', 0),
        ('{actuator: "**", where: {joint: "/t.*/"}}', 1),
        ('{actuator: "**", where: {biastype: affine}}', 1),
        ('{actuator: "**", where: {site: tip, refsite: tip}}', 1),
        ('{equality: "**", where: {type: connect, body2: b}}', 1),
        ('{equality: "**", where: {body2: a}}', 0),
        ('{equality: "**", where: {joint1: turn}}', 1),
        ('{sensor: "**", where: {type: framepos, objname: a, refname: tip}}', 1),
        ('{sensor: "**", where: {type: distance, geom2: h}}', 1),
        ('{sensor: "**", where: {joint: push}}', 1),
        ('{pair: "**", where: {geom1: h}}', 1),
        ('{exclude: "**", where: {body1: a}}', 1),
        ('{geom: "/[gh]/"}', 2),
    ],
)
def test_kinds_and_names(ask, selector: str, count: int) -> None:
    assert ask(WORDS, f"exists: [{selector[:-1]}, expect: {count}}}]") == []


def test_names_of_a_nested_recipe_are_as_it_writes_them(ask, arm: str) -> None:
    assert ask(arm, 'exists: [{actuator: "**", where: {joint: shoulder}, expect: 2}]', prefix="left/") == []


def test_a_slow_regular_expression(ask, arm: str) -> None:
    (finding,) = ask(arm.replace("left/tcp", "a" * 60), 'exists: [{site: "/(.|.)*[!?]/"}]')
    assert finding.code == "selector"
    assert "takes longer than" in finding.message
