from __future__ import annotations

from tests.verify.checks.conftest import notes

BALL = """
<mujoco>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="a/ball" pos="0 0 .1"><freejoint name="a/ball"/><geom size=".1"/></body>
    <body name="b/disc" pos="0 3 1"><joint name="b/spin" axis="0 0 1"/><geom size=".1"/></body>
  </worldbody>
  <keyframe>
    <key name="high" qpos="0 0 9 1 0 0 0 0"/>
    <key name="turning" qvel="0 0 0 0 0 0 2"/>
    <key name="mad" qvel="0 0 1e12 0 0 0 0"/>
  </keyframe>
</mujoco>
"""


def test_what_rests_holds(ask) -> None:
    assert ask(BALL, "settles: {seconds: 0.5}") == []


def test_what_falls_does_not(ask) -> None:
    (finding,) = ask(BALL, "settles: {key: high, seconds: 0.5, max_speed: 0.1}")
    assert finding.at == ("max_speed",)
    assert finding.message.startswith("joint `a/ball` still moves at 4.9")
    assert notes(finding)[0] == "expected: at most 0.1 m/s"


def test_an_angular_speed(ask) -> None:
    (finding,) = ask(BALL, "settles: {key: turning, seconds: 0.1}")
    assert notes(finding) == ("expected: at most 0.05 rad/s", "actual: 2 rad/s")
    assert ask(BALL, "settles: {key: turning, seconds: 0.1, max_speed: 2.01}") == []


def test_what_diverges_does_not_although_mujoco_resets_it(ask) -> None:
    (finding,) = ask(BALL, "settles: {key: mad, seconds: 0.5, max_speed: 1e9}")
    assert finding.at == ("seconds",)
    assert finding.message == "the simulation diverges after 0.002 s"


def test_in_a_nested_recipe_only_its_own_joints_count(ask) -> None:
    assert ask(BALL, "settles: {key: turning, seconds: 0.1}", prefix="a/") == []
    assert len(ask(BALL, "settles: {key: turning, seconds: 0.1}", prefix="b/")) == 1


def test_a_key_that_is_not_there(ask) -> None:
    (finding,) = ask(BALL, "settles: {key: hihg}")
    assert (finding.code, finding.at, finding.help) == ("unknown-name", ("key",), "did you mean `high`?")


def test_keys_that_were_left_out(ask) -> None:
    (finding,) = ask(BALL, "settles: {key: high}", keys=None)
    assert finding.code == "unknown-name"
    assert notes(finding) == ("the recipe around it leaves them out: `drop: [key]`",)
