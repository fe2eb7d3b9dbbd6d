"""The verb `remove`, alone and with all that refers."""

from __future__ import annotations

from pathlib import Path

import pytest
from compose.arm import Case, changed
from lxml import etree
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.sources.context import Context


def test_what_is_referred_to_stays(radian: Case) -> None:
    assert radian.told("{select: {joint: elbow}, remove: true}") == ["38 still-referred-to"]
    for word in ("a2", "m1", "s1"):
        assert f"`{word}` refers to the joint `elbow`" in radian.said
    assert "remove: cascade" in radian.said


def test_a_cascade_takes_all_that_refers(radian: Case, own: bool) -> None:
    model = radian.edited("{select: {body: link2}, remove: cascade}", own)
    before = radian.model("recipe: 1\nbase: ./arm.xml\n")
    gone = {each for each in changed(before, model) if each.startswith("-")}
    assert gone == {"-link2", "-tray", "-elbow", "-lower", "-tip", "-a2", "-m1", "-s1", "-s2"}
    assert {each for each in changed(before, model) if not each.startswith("-")} <= {
        "home qpos",
        "home qvel",
        "home ctrl",
        "other qpos",
        "other ctrl",
        "home act",
        "other qvel",
        "other act",
    }


HAND = """<mujoco model="hand">
  <extension><plugin plugin="mujoco.pid"><instance name="first"><config key="kp" value="40"/></instance>
    <instance name="second"><config key="kp" value="20"/></instance></plugin></extension>
  <worldbody><body name="a"><joint name="ja"/><geom size=".1"/>
    <body name="b"><joint name="jb"/><geom size=".1"/></body></body></worldbody>
  <actuator><plugin name="pa" plugin="mujoco.pid" instance="first" joint="ja"/>
    <plugin name="pb" plugin="mujoco.pid" instance="second" joint="jb"/></actuator>
</mujoco>"""


@pytest.mark.parametrize(
    ("change", "kept"),
    [
        ("attach: {h: {model: ./hand.xml, edit: [{select: {actuator: pa}, remove: true}]}}", ["h/second"]),
        ("attach: {h: {model: ./hand.xml, drop: [actuator]}}", []),
        ("base: {model: ./hand.xml, drop: [{joint: jb}]}", ["first"]),
        ("base: ./hand.xml\nedit: [{select: {body: b}, remove: cascade}]", ["first"]),
        ("attach: {h: {model: ./hand.xml}}\nedit: [{select: {actuator: h/pb}, convert: {to: motor}}]", ["h/first"]),
    ],
)
def test_plugin_instances_go_with_the_last_element_that_uses_them(tmp_path: Path, change: str, kept: list[str]) -> None:
    """MuJoCo refuses the instance of no actuator."""
    (tmp_path / "hand.xml").write_text(HAND)
    (tmp_path / "recipe.yaml").write_text(f"recipe: 1\nallow: [license-missing, convert-loss]\n{change}\n")
    context = Context(environment={}, folder=tmp_path)
    built = build(ModelRequest(tmp_path / "recipe.yaml"), context)
    assert built is not None, context.sink.errors
    model = etree.fromstring(built.bundle.files["model.xml"])
    assert [each.get("name") for each in model.iter("instance")] == kept
