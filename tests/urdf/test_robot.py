from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree
from mjcompose.base.diagnostic import Span
from mjcompose.tree.unit import FileText, Origins, Unit
from mjcompose.urdf.read import UrdfReader
from mjcompose.urdf.robot import _no_size, locate_in_urdf, mesh_of, name_fused_links
from urdf.parts import ARM, INERTIAL, link, robot

URDF = b"""<robot name="arm">
  <mujoco><option timestep="0.1"/></mujoco>
  <link name="base">
    <inertial><mass value="2"/></inertial>
    <visual><geometry><sphere radius="1"/></geometry></visual>
    <collision><geometry><mesh filename="package://arm/meshes/a.stl"/></geometry></collision>
    <collision><origin xyz="0 0 1"/><geometry><mesh filename="b.stl" scale="2 2 2"/></geometry></collision>
  </link>
  <link name="tool"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <joint name="turn" type="planar"><parent link="base"/><child link="tool"/><axis xyz="0 0 1"/>
    <mimic joint="x"/></joint>
</robot>"""
MJCF = """<mujoco model="arm">
  <option timestep="0.1"/>
  <asset><mesh name="a" file="/somewhere/arm/meshes/a.stl"/><mesh name="b" file="b.stl" scale="2 2 2"/></asset>
  <worldbody>
    <body name="base">
      <inertial mass="2"/>
      <joint name="turn_TX" axis="0 0 1"/>
      <geom mesh="a"/>
      <geom mesh="b" pos="0 0 1"/>
      <frame name="tool"><geom type="box"/><geom type="box"/></frame>
    </body>
  </worldbody>
  <equality><joint joint1="turn"/></equality>
</mujoco>"""


@pytest.fixture
def unit() -> Unit:
    unit = Unit(etree.fromstring(MJCF), "arm.urdf", Path(), "arm")
    locate_in_urdf(unit, etree.fromstring(URDF), Origins(texts={"arm.urdf": FileText(contents=URDF)}))
    return unit


@pytest.mark.parametrize(
    ("path", "attribute", "line", "text"),
    [
        (".", None, 1, "<robot"),
        ("option", "timestep", 2, "0.1"),
        ("asset/mesh[1]", "file", 6, "package://arm/meshes/a.stl"),
        ("asset/mesh[2]", "scale", 7, "2 2 2"),
        ("worldbody", None, 1, "<robot"),
        ("worldbody/body", None, 3, "<link"),
        ("worldbody/body", "name", 3, "base"),
        ("worldbody/body", "pos", 3, "<link"),
        ("worldbody/body/inertial", "mass", 4, "2"),
        ("worldbody/body/joint", "axis", 10, "0 0 1"),
        ("worldbody/body/joint", "name", 10, "turn"),
        ("worldbody/body/joint", "damping", 10, "<joint"),
        ("worldbody/body/geom[1]", "mesh", 6, "package://arm/meshes/a.stl"),
        ("worldbody/body/geom[2]", "pos", 7, "0 0 1"),
        ("worldbody/body/frame", None, 9, "<link"),
        ("worldbody/body/frame/geom[2]", None, 9, "<link"),
        ("equality/joint", None, 11, "<mimic"),
    ],
)
def test_places(unit: Unit, path: str, attribute: str | None, line: int, text: str) -> None:
    (element,) = unit.root.xpath(path)
    span = unit.origins.span(element, unit.file, attribute)
    lines = URDF.decode().splitlines()
    assert span.file == "arm.urdf" and span.end_column is not None
    assert (span.line, lines[span.line - 1][span.column - 1 : span.end_column - 1]) == (line, text)


def test_places_survive_a_copy(unit: Unit) -> None:
    (joint,) = unit.copied().root.iter("inertial")
    assert unit.copied().origins.span(joint, "other") == Span("other", joint.sourceline, 1)
    copy = unit.copied()
    (joint,) = copy.root.iter("inertial")
    assert copy.origins.span(joint, copy.file).line == 4


def test_fused_links_get_their_names() -> None:
    root = etree.fromstring(
        '<mujoco><worldbody><frame pos="1 0 0"><frame name="base"/><body name="a" fuse="false"><frame name="a"/>'
        '<frame><frame name="b"/><frame name="c"/></frame><frame name="d"/></body></frame></worldbody></mujoco>'
    )
    name_fused_links(root)
    assert etree.tostring(root).decode() == (
        '<mujoco><worldbody><frame pos="1 0 0" name="base"><body name="a">'
        '<frame name="b"><frame name="c"/></frame><frame name="d"/></body></frame></worldbody></mujoco>'
    )


@pytest.mark.parametrize(
    ("file", "line"), [("/x/arm/meshes/a.stl", 6), ("meshes\\a.stl", 6), ("b.stl", 7), ("other/b.stl", 7), ("c.stl", 1)]
)
def test_the_mesh_that_names_a_file(file: str, line: int) -> None:
    assert mesh_of(etree.fromstring(URDF), file).sourceline == line


def test_a_geometry_outside_of_a_shape_has_no_size_to_report() -> None:
    flag = '<flag><geometry><sphere radius="0.1"/></geometry></flag>'
    shape = '<collision><geometry><cylinder radius="0.1" length="0"/></geometry></collision>'
    robot = etree.fromstring(f'<robot><link name="base">{flag}{shape}</link></robot>')
    found = _no_size(robot, robot, lambda element, attribute=None: Span("arm.urdf", 1, 1))
    assert found is not None and found.message == "`length` of `<cylinder>` must be positive"


@pytest.mark.parametrize("written", ["file:///ws/arm/base.stl", "/ws/arm/base.stl"])
def test_an_absolute_path_of_another_machine_gets_advice(reader: Callable[..., UrdfReader], written: str) -> None:
    """The message is the same whether the file exists or not."""
    shape = f'<collision><geometry><mesh filename="{written}"/></geometry></collision>'
    read = reader("r.urdf", robot(ARM[0], link("upper", INERTIAL + shape), *ARM[2:]))
    assert read.unit() is None
    (error,) = read.sink.errors
    assert error.code == "source-outside"
    assert error.help is None or error.help.startswith("write a path relative to the URDF, or `package://NAME/…`; ")
