from __future__ import annotations

import pytest
from link.workshop import BASE, Workshop

FREE = """
<mujoco><compiler {settings}/><worldbody>
  <body name="b" pos="0 0 1">{joint}<geom size=".1" pos="1 0 0"/><geom type="box" size=".1 .2 .3" euler="10 20 30"/></body>
</worldbody></mujoco>"""
FREE_JOINTS = [
    "<freejoint/>",
    '<freejoint align="auto"/>',
    '<freejoint align="false"/>',
    '<freejoint align="true"/>',
    '<joint type="free"/>',
    '<joint type="free" name="j" group="2"/>',
    '<joint type="free" damping="3"/><body name="child"><geom size=".1"/></body>',
]


@pytest.mark.parametrize("joint", FREE_JOINTS)
@pytest.mark.parametrize("align", ["true", "false"])
def test_free_bodies_are_aligned_as_they_were(workshop: Workshop, joint: str, align: str) -> None:
    model = FREE.format(settings=f'alignfree="{align}"', joint=joint)
    workshop.link(BASE, model).check()
    workshop.link(model, FREE.format(settings="", joint="<freejoint/>")).check()


@pytest.mark.parametrize(
    ("joint", "default"),
    [
        ('<joint type="free" damping="3"/>', ""),
        ('<joint type="free"/>', '<default><joint armature="1"/></default>'),
    ],
)
def test_a_free_joint_with_settings_cannot_be_aligned(workshop: Workshop, joint: str, default: str) -> None:
    model = FREE.format(settings='alignfree="true"', joint=joint).replace(
        "<worldbody>", f"{default}<worldbody>"
    )
    fault = workshop.link(BASE, model).fault
    assert fault.code == "compiler-setting"
    assert "`alignfree`" in fault.message


@pytest.mark.parametrize("joint", FREE_JOINTS[:6])
@pytest.mark.parametrize(
    "settings", ['settotalmass="7"', 'boundmass="1000"', 'fusestatic="true"', 'fitaabb="true"']
)
def test_what_is_measured_is_measured_in_the_frame_before_alignment(
    workshop: Workshop, joint: str, settings: str
) -> None:
    model = FREE.format(settings=f'alignfree="true" {settings}', joint=joint)
    workshop.link(BASE, model).check()
    workshop.link(model, BASE).check()


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
