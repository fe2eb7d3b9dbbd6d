from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from link.workshop import BASE, Piece, Workshop, placed

from composer.diagnostics.sink import Sink
from composer.link.angles import angles
from composer.link.linking import Linking
from composer.link.part import Part

SEQUENCES = ("xyz", "zyx", "XYZ", "zXy", "yzY")

ORIENTED = """
<mujoco model="oriented">
  <compiler {settings}/>
  <default>
    <default class="turned">
      <geom euler="10 20 30" type="box" size=".1 .2 .3"/>
      <site axisangle="1 2 3 40"/>
      <camera euler="1 0 -50"/>
    </default>
  </default>
  <worldbody>
    <geom type="box" size="1 2 3" axisangle="0 1 1 33"/>
    <site euler="-10 .5 200"/>
    <body name="mount" pos="0 0 4"/>
    <body euler="7 8 9" pos="1 0 0">
      <inertial pos="0 0 .1" mass="1" diaginertia="1 1.2 1.4" euler="5 5 5"/>
      <geom class="turned"/>
      <geom class="turned" quat="1 1 0 0"/>
      <geom class="turned" zaxis="1 1 0"/>
      <site class="turned" pos="1 0 0"/>
      <camera class="turned"/>
      <camera euler="0x1p3 0 0" fovy="40"/>
      <frame euler="1 2 3"><site/><frame axisangle="0 0 2 90"><geom size=".1" euler=""/></frame></frame>
      <joint range="-90 45" ref="5" springref="10"/>
      <body axisangle="1 0 0 -45"><joint type="ball" range="0 80"/><geom size=".1"/></body>
    </body>
    <flexcomp name="cloth" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" mass="1" radius=".01"
      euler="3 4 5"/>
  </worldbody>
</mujoco>
"""

MOUNT = placed("body", "mount")

JOINTS = """
<mujoco>
  <compiler angle="{angle}" autolimits="{autolimits}"/>
  <default>
    <joint springref="5" {limited}/>
    <default class="both"><joint range="-20 30" ref="3"/></default>
    <default class="hinges"><joint range="-20 30" ref="4"/></default>
    <default class="slides"><joint type="slide" range="-1 2" ref=".5"/></default>
    <default class="unused"><joint type="slide" range="-1 2"/></default>
    <default class="open"><joint limited="false" range="-10 10"/></default>
    <default class="backward"><joint range="30 -30"/></default>
  </default>
  <worldbody>
    {bodies}
  </worldbody>
</mujoco>
"""
JOINT_KINDS = [
    '<joint class="both"/>',
    '<joint class="both" type="slide"/>',
    '<joint class="both" type="ball" range="0 90"/>',
    '<joint class="both" ref="7"/>',
    '<joint class="hinges"/>',
    '<joint class="hinges" range="1 2"/>',
    '<joint class="slides"/>',
    '<joint class="slides" type="hinge"/>',
    '<joint class="slides" springref=".1"/>',
    '<joint range="-1 1"/>',
    '<joint type="ball" range="0 30"/>',
    '<joint type="ball" ref="30"/>',
    '<joint type="slide" range="-1 1"/>',
    '<joint ref="-12"/>',
]
UNLIMITED = [
    '<joint class="open"/>',
    '<joint limited="auto" range="0 0" ref="-12"/>',
    '<joint limited="false" range="-5 5"/>',
]
BACKWARD = ['<joint class="backward" limited="auto"/>']


def joints(angle: str, autolimits: str, kinds: list[str]) -> str:
    limited = 'limited="true" range="0 1"' if autolimits == "false" else ""
    bodies = "".join(f'<body><geom size=".1"/>{kind}</body>' for kind in kinds)
    return JOINTS.format(angle=angle, autolimits=autolimits, limited=limited, bodies=bodies)


def oriented(angle: str, sequence: str) -> str:
    return ORIENTED.format(settings=f'angle="{angle}" eulerseq="{sequence}"')


@pytest.mark.parametrize(("base", "part"), [*itertools.product(("degree", "radian"), repeat=2)])
@pytest.mark.parametrize("sequence", SEQUENCES)
@pytest.mark.mujoco4("an orientation of the class wins over one of the element")
def test_every_orientation_keeps_its_bits(workshop: Workshop, base: str, part: str, sequence: str) -> None:
    linked = workshop.link(oriented(base, "xyz"), Piece(oriented(part, sequence), place=MOUNT))
    linked.check()
    assert linked.linking.base.root.find("compiler").get("angle") == (
        "degree" if base == part == "degree" else "radian"
    )


@pytest.mark.mujoco4("an orientation of the class wins over one of the element")
def test_the_sequence_of_the_model_is_that_of_the_base(workshop: Workshop) -> None:
    part = Piece(oriented("degree", "xyz"), place=MOUNT)
    linked = workshop.link(oriented("radian", "zXy"), part, Piece(BASE, "other/"))
    linked.check()
    assert 'eulerseq="zXy"' in linked.xml


def test_nothing_is_rewritten_where_all_agree(workshop: Workshop) -> None:
    linked = workshop.link(oriented("degree", "zyx"), Piece(oriented("degree", "zyx")))
    assert linked.xml.count('euler="7 8 9"') == 2
    assert linked.xml.count('range="-90 45"') == 2


def test_a_base_without_parts_is_left_alone(workshop: Workshop) -> None:
    linked = workshop.link(oriented("degree", "zyx"))
    assert 'euler="-10 .5 200"' in linked.xml
    linked.check()


@pytest.mark.parametrize("autolimits", ["true", "false"])
@pytest.mark.parametrize("angle", ["degree", "radian"])
def test_ranges_and_references_of_joints_keep_their_bits(
    workshop: Workshop, angle: str, autolimits: str
) -> None:
    kinds = JOINT_KINDS + UNLIMITED + (BACKWARD if autolimits == "true" else [])
    radian = '<mujoco><compiler angle="radian"/></mujoco>'
    workshop.link(radian, Piece(joints(angle, autolimits, kinds))).check()
    workshop.link(joints(angle, autolimits, kinds), Piece(radian)).check()


@pytest.mark.parametrize("kind", JOINT_KINDS + UNLIMITED + BACKWARD)
def test_each_joint_by_itself_keeps_its_bits(workshop: Workshop, kind: str) -> None:
    """A class that serves one joint alone turns with it."""
    radian = '<mujoco><compiler angle="radian"/></mujoco>'
    workshop.link(radian, Piece(joints("degree", "true", [kind]))).check()


def test_a_class_for_hinges_and_slides_gives_each_what_it_gave(workshop: Workshop) -> None:
    linked = workshop.link(
        '<mujoco><compiler angle="radian"/></mujoco>', joints("degree", "true", JOINT_KINDS)
    )
    model = linked.check()
    assert model.jnt_range[0] == pytest.approx(np.radians([-20, 30]))
    assert model.jnt_range[1].tolist() == [-20, 30]


def test_joints_inside_frames_and_replicates_are_reached(workshop: Workshop) -> None:
    part = """
    <mujoco><default><default class="c"><joint range="-30 30"/></default></default><worldbody>
      <replicate count="3" euler="0 0 30" offset="1 0 0">
        <body childclass="c"><geom size=".1"/><frame pos="1 0 0"><joint ref="2"/></frame></body>
      </replicate>
      <frame childclass="c"><body><geom size=".1"/><joint type="slide"/></body></frame>
    </worldbody></mujoco>"""
    workshop.link('<mujoco><compiler angle="radian"/></mujoco>', part).check()


@pytest.mark.parametrize("sequence", ["zyx", "XYZ", "yxz"])
@pytest.mark.parametrize("euler", ["30 0 0", "0 -20 0", "0 0 77", "0 0 0"])
def test_a_replicate_about_one_axis_turns_the_same_in_every_sequence(
    workshop: Workshop, sequence: str, euler: str
) -> None:
    part = f"""
    <mujoco><compiler eulerseq="{sequence}"/><worldbody>
      <replicate count="3" euler="{euler}" offset="1 2 3"><geom size=".1" euler="10 20 30"/></replicate>
    </worldbody></mujoco>"""
    workshop.link(BASE, part).check()


def test_a_replicate_about_several_axes_cannot_change_its_sequence(workshop: Workshop) -> None:
    part = """<mujoco><compiler eulerseq="zyx"/><worldbody>
      <replicate count="3" euler="30 20 0"><geom name="g" size=".1"/></replicate></worldbody>
      <contact><pair geom1="g0" geom2="g1"/><pair geom1="g" geom2="g"/></contact></mujoco>"""
    fault = workshop.link(BASE, part).fault
    assert fault.code == "compiler-setting"
    assert fault.span is not None
    assert (fault.span.line, fault.span.column) == (2, 7)


def test_a_replicate_about_an_axis_that_the_sequence_lacks_is_told(workshop: Workshop) -> None:
    base = '<mujoco><compiler eulerseq="xyx"/></mujoco>'
    part = """<mujoco><worldbody>
      <replicate count="2" euler="0 0 30"><geom size=".1"/></replicate></worldbody></mujoco>"""
    assert workshop.link(base, part).fault.code == "compiler-setting"


@settings(max_examples=25, deadline=None, derandomize=True)
@given(
    st.lists(st.tuples(*[st.floats(-360, 360)] * 3), min_size=1, max_size=10),
    st.sampled_from(["xyz", "ZYX", "xYz", "yxy"]),
    st.sampled_from(["degree", "radian"]),
)
def test_random_angles_keep_their_bits(
    tmp_path_factory: pytest.TempPathFactory,
    eulers: list[tuple[float, float, float]],
    sequence: str,
    angle: str,
) -> None:
    workshop = Workshop(tmp_path_factory.mktemp("angles"))
    elements = "".join(
        f'<body euler="{a!r} {b!r} {c!r}"><geom size="1"/><joint ref="{a!r}"/><site axisangle="1 2 3 {b!r}"/></body>'
        for a, b, c in eulers
    )
    part = (
        f'<mujoco><compiler eulerseq="{sequence}" angle="{angle}"/><worldbody>{elements}</worldbody></mujoco>'
    )
    base = '<mujoco><compiler angle="radian"/></mujoco>'
    workshop.link(base, Piece(part, place=placed(pos=(1.0, 2.0, 3.0)))).check()


def test_the_pass_by_itself_writes_quaternions_and_radians(workshop: Workshop) -> None:
    base = workshop.unit('<mujoco><compiler angle="radian"/></mujoco>')
    part = workshop.unit(
        '<mujoco><compiler eulerseq="zyx"/><worldbody><body euler="0 0 180"/>'
        '<frame axisangle="0 0 1 180"/><body><joint range="-180 0"/></body></worldbody></mujoco>'
    )
    angles(Linking(base, [Part(part, "p/")], Sink()))
    body, frame, other = part.root.find("worldbody")
    assert body.attrib == {"quat": "6.123233995736766e-17 1 0 0"}
    assert frame.attrib == {"axisangle": "0 0 1 3.141592653589793"}
    assert other[0].attrib == {"range": "-3.141592653589793 0"}
