from __future__ import annotations

import itertools

import mujoco
import pytest
from link.workshop import BASE, Piece, Workshop


def test_a_model_alone_keeps_everything_but_its_folders(workshop: Workshop) -> None:
    settings = (
        'fusestatic="true" discardvisual="true" autolimits="false" usethread="false" inertiafromgeom="true"'
        ' alignfree="true" angle="radian" eulerseq="zyx"'
    )
    model = f'<mujoco><compiler meshdir="m" texturedir="t" strippath="true" {settings}/><worldbody/></mujoco>'
    linked = workshop.link(model)
    compiler = linked.linking.base.root.find("compiler")
    kept = " ".join(f'{name}="{value}"' for name, value in compiler.items())
    assert kept == settings
    linked.check()


def test_several_compilers_become_one_and_the_last_word_counts(workshop: Workshop) -> None:
    model = """
    <mujoco><compiler angle="radian" eulerseq="zyx"/><worldbody><body name="b" euler="1 2 3"><geom size="1"/></body></worldbody>
      <compiler angle="degree"/><compiler><lengthrange inttotal="2"/></compiler></mujoco>"""
    alone = workshop.link(model)
    assert alone.xml.count("<compiler") == 1
    assert "inttotal" in alone.xml
    alone.check()
    workshop.link(model, BASE).check()
    workshop.link(BASE, model).check()


def test_settings_without_effect_are_dropped(workshop: Workshop) -> None:
    linked = workshop.link('<mujoco><compiler usethread="false" alignfree="false"/></mujoco>', BASE)
    assert dict(linked.linking.base.root.find("compiler").attrib) == {"angle": "degree"}


def test_the_compiler_stands_first(workshop: Workshop) -> None:
    linked = workshop.link(
        '<mujoco><worldbody/><option timestep=".01"/><compiler angle="radian"/></mujoco>', BASE
    )
    assert linked.linking.base.root[0].tag == "compiler"


LIMITED = """
<mujoco>
  <compiler autolimits="{auto}" angle="radian"/>
  <default><default class="k"><motor ctrlrange="-3 3" {ctrl}/><joint range="-2 1" {limited}/></default></default>
  <worldbody>
    <body>
      <joint name="h" range="-1 2" {limited}/>
      <joint name="s" type="slide" range="-1 2" {limited}/>
      <joint name="q" axis="1 0 0" actuatorfrcrange="-1 1" {jointforce}/>
      <joint name="k" axis="0 1 0" class="k"/>
      <joint name="off" axis="0 1 1" range="-1 1" limited="false"/>
      <geom size=".1"/>
      <body><joint type="ball" range="0 1" {limited}/><geom size=".1"/><site name="p"/></body>
    </body>
    <site name="w"/>
  </worldbody>
  <tendon>
    <fixed range="0 1" actuatorfrcrange="-1 1" {limited} {jointforce}><joint joint="h" coef="1"/></fixed>
    <spatial range="0 2" {limited}><site site="w"/><site site="p"/></spatial>
  </tendon>
  <actuator>
    <motor joint="h" ctrlrange="-1 1" forcerange="-2 2" {ctrl} {force}/>
    <motor joint="h" class="k"/>
    <general joint="h" dyntype="integrator" actrange="-1 1" {act}/>
    <position joint="h" inheritrange="1" {ctrl}/>
    <position joint="off" ctrlrange="-1 1" ctrllimited="false"/>
    <damper joint="h" ctrlrange="0 1"/>
  </actuator>
</mujoco>
"""
EXPLICIT = {
    "limited": 'limited="true"',
    "jointforce": 'actuatorfrclimited="true"',
    "ctrl": 'ctrllimited="true"',
    "force": 'forcelimited="true"',
    "act": 'actlimited="true"',
}


def limited(auto: str) -> str:
    return LIMITED.format(auto=auto, **(EXPLICIT if auto == "false" else dict.fromkeys(EXPLICIT, "")))


@pytest.mark.parametrize(("base", "part"), [*itertools.product(("true", "false"), repeat=2)])
def test_limits_stay_what_they_were(workshop: Workshop, base: str, part: str) -> None:
    model = workshop.link(limited(base), Piece(limited(part))).check()
    assert model.jnt_limited[: model.njnt // 2].tolist() == model.jnt_limited[model.njnt // 2 :].tolist()
    assert model.jnt_limited.sum() == 8
    assert model.actuator_ctrllimited.sum() == 8


@pytest.mark.parametrize(
    ("settings", "expected"),
    [(("false", "false"), "false"), (("false", "true"), None), (("true", "false"), None)],
)
def test_the_model_says_false_only_where_all_do(
    workshop: Workshop, settings: tuple[str, str], expected: str | None
) -> None:
    base, part = (f'<mujoco><compiler autolimits="{auto}"/></mujoco>' for auto in settings)
    linked = workshop.link(base, part)
    assert linked.linking.base.root.find("compiler").get("autolimits") == expected


@pytest.mark.parametrize(
    "inside",
    [
        '<worldbody><body><joint range="-1 1"/><geom size="1"/></body></worldbody>',
        '<worldbody><body><joint actuatorfrcrange="-1 1"/><geom size="1"/></body></worldbody>',
        (
            '<worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
            '<actuator><motor joint="j" ctrlrange="-1 1"/></actuator>'
        ),
        (
            '<worldbody><body><joint name="j"/><geom size="1"/></body></worldbody>'
            '<tendon><fixed range="0 1"><joint joint="j" coef="1"/></fixed></tendon>'
        ),
    ],
)
def test_mujoco_refuses_a_range_that_does_not_say_whether_it_limits(inside: str) -> None:
    """On this it rests that nothing has to be written."""
    with pytest.raises(ValueError, match="autolimits"):
        mujoco.MjModel.from_xml_string(f'<mujoco><compiler autolimits="false"/>{inside}</mujoco>')


def test_a_free_joint_is_not_limited_by_a_class(workshop: Workshop) -> None:
    part = """<mujoco><compiler autolimits="false"/><worldbody>
      <body name="b"><joint type="free" range="-1 1"/><geom size="1"/></body></worldbody></mujoco>"""
    workshop.link(BASE, part).check()


def test_length_ranges_of_several_compilers_become_one(workshop: Workshop) -> None:
    model = """
    <mujoco><compiler><lengthrange mode="all"/></compiler><worldbody/>
      <compiler><lengthrange inttotal="2"/></compiler></mujoco>"""
    linked = workshop.link(model)
    (found,) = linked.linking.base.root.iter("lengthrange")
    assert dict(found.attrib) == {"mode": "all", "inttotal": "2"}
    linked.check()
