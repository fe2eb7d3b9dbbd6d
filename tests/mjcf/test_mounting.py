"""Settings that only MuJoCo can work out on a model alone, where that model refers to what hangs on it."""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import pytest
from mjcompose import mjcf
from mjcompose.mjcf import RootElement


@pytest.fixture
def cell() -> RootElement:
    """Its mass is scaled, which is measured; what hangs on it is referred to from every section."""
    cell = RootElement("cell")
    ball = RootElement("ball")
    cell.compiler.settotalmass = 3
    table = cell.worldbody.add("body", name="table")
    table.add("joint", name="slide", type="slide")
    table.add("geom", name="top", size=[0.5])
    ball.worldbody.add("geom", name="shell", size=[0.1])
    core = ball.worldbody.add("body", name="core")
    core.add("joint", name="turn")
    core.add("geom", name="hull", size=[0.1])
    core.add("site", name="tip")
    ball.asset.add("material", name="steel")
    frame = cell.attach(ball)
    frame.add("joint", name="lift", type="slide")

    cell.equality.add("weld", body1=frame, body2=table)
    both = cell.tendon.add("fixed", name="both")
    both.add("joint", joint=core.find("joint"), coef=1)
    both.add("joint", joint="slide", coef=1)
    cell.actuator.add("position", name="turn", joint="ball/turn", kp=3)
    cell.actuator.add("motor", name="slide", joint="slide")
    cell.actuator.add("adhesion", name="stick", body="ball/core", ctrlrange=[0, 1])
    cell.actuator.add("position", name="both", tendon=both, kp=1)
    cell.sensor.add("tendonpos", tendon=both)
    cell.sensor.add("touch", site="ball/tip")
    cell.contact.add("exclude", body1=table, body2="ball/core")
    cell.contact.add("pair", geom1="top", geom2="ball/hull")
    cell.custom.add("tuple", name="all").add("element", objtype="body", objname="ball/core")
    table.geom[0].material = "ball/steel"
    return cell


def test_the_model_is_measured_without_what_hangs_on_it(
    cell: RootElement, compiled: Callable[[RootElement], mujoco.MjModel]
) -> None:
    cell.compiler.settotalmass = None
    plain = compiled(cell)
    cell.compiler.settotalmass = 3
    before = str(cell)
    model = compiled(cell)
    assert model.body("table").mass == 3 and model.body("ball/core").mass == plain.body("ball/core").mass
    assert [model.nu, model.ntendon, model.nsensor, model.neq, model.npair, model.nexclude, model.ntuple] == [
        4,
        1,
        2,
        1,
        1,
        1,
        1,
    ]
    assert model.actuator("turn").trnid[0] == model.joint("ball/turn").id
    assert str(cell) == before


def test_a_weld_to_the_frame_of_what_hangs_on_it() -> None:
    cell = RootElement("cell")
    ball = RootElement("ball")
    cell.compiler.boundmass = 2
    cell.worldbody.add("body", name="table").add("geom", size=[0.01])
    ball.worldbody.add("geom", size=[0.1])
    frame = cell.attach(ball)
    frame.add("freejoint")
    cell.equality.add("weld", body1=frame)
    model = cell.compile_model().model
    assert model.eq_obj1id[0] == model.body("ball/").id and model.body("table").mass == 2


def test_mass_that_hangs_on_it_is_told_as_missing() -> None:
    """A geom with a mesh of the attached model cannot be weighed without that."""
    cell = RootElement("cell")
    tool = RootElement("tool")
    cell.compiler.boundmass = 2
    tool.asset.add("mesh", name="m", vertex=[0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1])
    cell.attach(tool)
    cell.worldbody.add("body").add("geom", type="mesh", mesh="tool/m")
    with pytest.raises(mjcf.MjcfError, match="m"):
        cell.compile_model()


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
        ("name-clash", "another body is already called `x`", 1),
        ("name-clash", "another joint is already called `j`", 2),
        ("name-clash", "another mesh is already called `m`", 3),
        ("class-clash", "another default class is already called `c`", 4),
    ]


@pytest.mark.parametrize(
    "sizes",
    [
        'njmax="100" nconmax="5"|memory="2M"',
        pytest.param(
            'memory="2M"|njmax="100" nstack="5000"', marks=pytest.mark.since("3.12", "it refuses both sizes together")
        ),
    ],
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
    assert (model.option.timestep, model.option.flag.contact, model.option.flag.energy) == (0.2, "disable", "enable")
    assert (model.visual.map.znear, model.visual.map.zfar) == (0.5, 9)
    one = mujoco.MjModel.from_xml_string(text)
    other = mujoco.MjModel.from_xml_string(model.to_xml_string())
    assert one.geom_group.tolist() == other.geom_group.tolist() == [2, 1]
    assert one.geom_quat.tolist() == other.geom_quat.tolist()
    assert one.opt.timestep == other.opt.timestep and one.vis.map.zfar == other.vis.map.zfar


def test_comments_stay() -> None:
    model = mjcf.from_xml_string("<mujoco><!-- a --><worldbody><!-- b --><geom size='1'/></worldbody></mujoco>")
    assert len(model.worldbody.all_children()) == 1 and "<!-- b -->" in model.to_xml_string()


def test_what_mujoco_ignores_is_no_fault() -> None:
    """Such a model loads in MuJoCo, which passes over the attribute."""
    text = """<mujoco><worldbody><replicate count="3" prefix="A"><geom size="1"/></replicate></worldbody></mujoco>"""
    model = mjcf.from_xml_string(text)
    assert mujoco.MjModel.from_xml_string(model.to_xml_string()).ngeom == 3
