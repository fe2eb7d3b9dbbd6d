from __future__ import annotations

import mujoco
import pytest

from composer import mjcf


def test_all_faults_of_a_text_are_told_at_once() -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        mjcf.from_xml_string(
            "<mujoco modle='m'><worldbody><goem/><geom siez='1'/><site><geom/></site></worldbody>"
            "<tendon><fixed><geom/></fixed></tendon></mujoco>"
        )
    told = [fault.message for fault in caught.value.diagnostics]
    assert sorted(told) == [
        "`<fixed>` cannot have a `<geom>`",
        "`<site>` cannot have a `<geom>`",
        "`<worldbody>` cannot have a `<goem>`",
        "`modle` is not an attribute of `<mujoco>`",
        "`siez` is not an attribute of `<geom>`",
    ]


def test_names_that_stand_twice_are_told_where_the_second_one_is() -> None:
    with pytest.raises(mjcf.MjcfError) as caught:
        mjcf.from_xml_string(
            "<mujoco><worldbody><body name='x'><joint name='j'/></body><body name='x'>\n<freejoint name='j'/></body>"
            "</worldbody><asset>\n<mesh file='a/m.stl'/><mesh file='b/m.stl'/><model name='x' file='a.xml'/>"
            "<model name='x' file='a.xml'/></asset><default><default class='c'/>\n<default class='c'/></default>"
            "<worldbody>\n<geom name='' size='1'/><geom name='' size='1'/></worldbody></mujoco>"
        )
    told = [(fault.code, fault.message, fault.span and fault.span.line) for fault in caught.value.diagnostics]
    assert told == [
        ("name-clash", "another body is called `x` already", 1),
        ("name-clash", "another joint is called `j` already", 2),
        ("name-clash", "another mesh is called `m` already", 3),
        ("class-clash", "another default class is called `c` already", 4),
    ]


@pytest.mark.parametrize(
    "sizes", ['njmax="100" nconmax="5"|memory="2M"', 'memory="2M"|njmax="100" nstack="5000"']
)
def test_memory_wins_over_what_was_in_its_place_once(sizes: str) -> None:
    first, second = sizes.split("|")
    text = f'<mujoco><size {first}/><size {second}/><worldbody><geom size="1"/></worldbody></mujoco>'
    model = mjcf.from_xml_string(text).compile_model().model
    assert model.narena == mujoco.MjModel.from_xml_string(text).narena == 2 << 20


def test_sections_written_twice_become_one() -> None:
    text = (
        "<mujoco><compiler angle='radian'/><option timestep='0.1'><flag contact='disable'/></option>"
        "<worldbody><geom name='a' size='1'/></worldbody><visual><map znear='0.5'/></visual>"
        "<default><geom group='1'/><default class='x'/></default>"
        "<compiler angle='degree' eulerseq='zyx'/><option gravity='0 0 0' timestep='0.2'>"
        "<flag energy='enable'/></option><visual><map zfar='9'/><rgba haze='1 1 1 1'/></visual>"
        "<worldbody><geom name='b' size='1' euler='10 20 30' class='x'/></worldbody>"
        "<default><geom group='2'/></default></mujoco>"
    )
    model = mjcf.from_xml_string(text)
    assert [each.name for each in model.worldbody.geom] == ["a", "b"]
    assert (model.compiler.angle, model.compiler.eulerseq) == ("degree", "zyx")
    assert (model.option.timestep, model.option.flag.contact, model.option.flag.energy) == (
        0.2,
        "disable",
        "enable",
    )
    assert (model.visual.map.znear, model.visual.map.zfar) == (0.5, 9)
    one, other = mujoco.MjModel.from_xml_string(text), mujoco.MjModel.from_xml_string(model.to_xml_string())
    assert one.geom_group.tolist() == other.geom_group.tolist() == [2, 1]
    assert one.geom_quat.tolist() == other.geom_quat.tolist()
    assert one.opt.timestep == other.opt.timestep and one.vis.map.zfar == other.vis.map.zfar


def test_comments_stay() -> None:
    model = mjcf.from_xml_string(
        "<mujoco><!-- a --><worldbody><!-- b --><geom size='1'/></worldbody></mujoco>"
    )
    assert len(model.worldbody.all_children()) == 1 and "<!-- b -->" in model.to_xml_string()


def test_what_mujoco_ignores_is_no_fault() -> None:
    """Such a model loads in MuJoCo, which passes over the attribute."""
    text = """<mujoco><worldbody><replicate count="3" prefix="A"><geom size="1"/></replicate></worldbody></mujoco>"""
    model = mjcf.from_xml_string(text)
    assert mujoco.MjModel.from_xml_string(model.to_xml_string()).ngeom == 3
