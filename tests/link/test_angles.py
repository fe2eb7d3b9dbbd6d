from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from link.workshop import BASE, Piece, Workshop, placed
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.link.angles import angles, undo_settings
from mjcompose.link.linking import Joint, Linking, Part, SensorBody

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
def test_ranges_and_references_of_joints_keep_their_bits(workshop: Workshop, angle: str, autolimits: str) -> None:
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
    linked = workshop.link('<mujoco><compiler angle="radian"/></mujoco>', joints("degree", "true", JOINT_KINDS))
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
    tmp_path_factory: pytest.TempPathFactory, eulers: list[tuple[float, float, float]], sequence: str, angle: str
) -> None:
    workshop = Workshop(tmp_path_factory.mktemp("angles"))
    elements = "".join(
        f'<body euler="{a!r} {b!r} {c!r}"><geom size="1"/><joint ref="{a!r}"/><site axisangle="1 2 3 {b!r}"/></body>'
        for a, b, c in eulers
    )
    part = f'<mujoco><compiler eulerseq="{sequence}" angle="{angle}"/><worldbody>{elements}</worldbody></mujoco>'
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


FLEX = '<flexcomp name="f" type="grid" count="2 2 1" spacing=".1 .1 .1" dim="2" radius=".01"/>'
ARM = '<body name="arm"><joint name="j"/><geom size=".1"/></body>'


def model(joint: str, inside: str) -> str:
    return f"<mujoco><default><joint {joint}/></default><worldbody>{inside}</worldbody></mujoco>"


def test_what_a_flex_in_the_world_takes_reaches_nothing_else(workshop: Workshop) -> None:
    base = model('armature=".5"', FLEX + ARM)
    found = workshop.link(base, Piece(model('stiffness="2"', ARM), "p/"), Piece(model("", ARM), "q/")).model()
    armature = found.dof_armature
    assert armature[found.jnt_dofadr[0]] == 0.5
    assert armature[found.joint("j").dofadr[0]] == 0.5
    assert [armature[found.joint(name).dofadr[0]] for name in ("p/j", "q/j")] == [0, 0]
    assert found.joint("p/j").stiffness[0] == 2


def test_without_joint_defaults_nothing_is_written(workshop: Workshop) -> None:
    linked = workshop.link(model("", FLEX), Piece(model("", FLEX), "p/"))
    assert "<joint " not in linked.xml


def test_two_flexes_in_the_world_that_take_different_defaults_are_refused(workshop: Workshop) -> None:
    linked = workshop.link(model('armature=".5"', FLEX), Piece(model('armature=".6"', FLEX), "p/"))
    assert linked.fault.code == "not-supported"
    assert 'armature="0.6"' in linked.fault.message or 'armature=".6"' in linked.fault.message


def test_user_data_has_no_neutral_value(workshop: Workshop) -> None:
    linked = workshop.link(model('user="1 2"', FLEX), Piece(model("", ARM), "p/"))
    assert linked.fault.code == "not-supported"


def test_a_flex_at_the_root_takes_the_defaults_of_its_mount(workshop: Workshop) -> None:
    base = """<mujoco><default><default class="x"><joint armature=".5"/></default></default><worldbody>
      <body name="plain"/><body name="classed" childclass="x"/></worldbody></mujoco>"""
    part = Piece(model("", FLEX), "p/", placed("body", "plain"))
    assert workshop.link(base, part).model().nflex == 1
    part = Piece(model("", FLEX), "p/", placed("body", "classed"))
    assert workshop.link(base, part).fault.code == "not-supported"


def test_a_flex_at_the_root_does_not_take_what_the_recipe_sets(workshop: Workshop) -> None:
    base = '<mujoco><worldbody><body name="plain"/></worldbody></mujoco>'
    on_body = Piece(model("", FLEX), "p/", placed("body", "plain"))
    fault = workshop.link(base, on_body, isolated_tags=frozenset({"joint"})).fault
    assert "the recipe sets for `main`" in fault.message
    workshop.link(base, on_body, isolated_tags=frozenset({"geom"})).check()
    workshop.link(base, Piece(model("", FLEX), "p/"), isolated_tags=frozenset({"joint"})).check()
    inside = Piece(model("", f'<body name="own">{FLEX}</body>'), "p/", placed("body", "plain"))
    workshop.link(base, inside, isolated_tags=frozenset({"joint"})).check()


TURNED = '<flexcomp name="f" type="grid" count="3 2 1" spacing=".1 .1 .1" dim="2" radius=".01" quat="{}"/>'


def turned(quat: str, inside: str = "{}") -> str:
    return f"<mujoco><worldbody>{inside.format(TURNED.format(quat))}</worldbody></mujoco>"


def test_a_quat_that_stretches_alone_is_refused_with_one_that_does_not(workshop: Workshop) -> None:
    fault = workshop.link(BASE, turned("1 1 0 0")).fault
    assert "a `quat` of length 1.41421" in fault.message
    assert fault.span is not None and fault.help is not None
    mended = fault.help.split('"')[1]
    workshop.link(BASE, turned(mended)).check()


def test_one_that_does_not_turn_stretches_nothing(workshop: Workshop) -> None:
    linked = workshop.link(BASE, turned("2 0 0 0"))
    assert linked.codes == []
    linked.check()


def test_one_that_hardly_stretches_is_reported(workshop: Workshop) -> None:
    linked = workshop.link(BASE, turned("0.7071 0.7071 0 0"))
    assert linked.codes == ["not-supported"] and not linked.sink.has_errors


@pytest.mark.parametrize(
    "inside",
    [
        '<body name="b">{}</body>',
        pytest.param("<frame>{}</frame>", marks=pytest.mark.mujoco4("it leaves flexes behind the frame around them")),
        '<body name="b"><frame pos="1 0 0">{}</frame></body>',
    ],
)
def test_in_a_body_or_a_frame_it_is_what_it_is_alone(workshop: Workshop, inside: str) -> None:
    linked = workshop.link(turned("1 1 0 0"), Piece(turned("1 1 0 0", inside), "p/", placed(pos=(1, 2, 3))))
    assert linked.codes == []
    linked.check()


@pytest.mark.parametrize("taken", ['type="slide"', 'axis="1 0 0"', 'pos="1 0 0"'])
def test_what_a_flex_decides_itself_is_no_default_of_it(workshop: Workshop, taken: str) -> None:
    workshop.link(model(taken, FLEX), Piece(model("", FLEX.replace('"f"', '"g"')), "p/")).check()


@pytest.mark.parametrize("damped", ['damping="3"', 'springdamper=".1 1"'])
def test_damping_is_no_default_of_a_flex(workshop: Workshop, damped: str) -> None:
    """MuJoCo refuses it to vertices that move; a rigid flex has none of these."""
    rigid = FLEX.replace("/>", ' rigid="true"/>')
    linked = workshop.link(model(damped, rigid + ARM), Piece(model("", rigid), "p/"))
    linked.check()
    assert "<joint " not in linked.xml.split("<worldbody>")[0].split("<default class")[0]


@pytest.mark.parametrize(
    "options",
    [
        {"joints": (Joint("freejoint", {}),)},
        {"joints": (Joint("joint", {"type": "hinge"}),)},
        {"mocap": True},
        {"sense": SensorBody("wrist", (("force", "wrist"),), "", Span("r.yaml", 1, 1))},
    ],
)
def test_a_flex_on_a_body_of_an_attachment_is_not_in_the_world(workshop: Workshop, options: dict[str, Any]) -> None:
    """It takes the joint defaults of that body, and `main` has none for it."""
    pinned = FLEX.replace("/>", '><pin id="0"/></flexcomp>')
    linked = workshop.link(BASE, Piece(model('armature=".5"', pinned), "p/", options=options))
    assert "<joint " not in linked.xml.split("<worldbody>")[0].split('class="p/"')[0]


@pytest.mark.parametrize(("length", "severity"), [(1.0005, "warning"), (1.002, "error"), (1.0 + 1e-12, None)])
def test_a_turn_that_stretches_is_an_error_from_a_thousandth_on(
    workshop: Workshop, length: float, severity: str | None
) -> None:
    flex = FLEX.replace("/>", f' quat="0 {length!r} 0 0"/>')
    found = workshop.link(BASE, Piece(model("", flex), "p/")).linking.sink.diagnostics
    told = [str(each.severity.value) for each in found if "turned by a `quat`" in each.message]
    assert told == ([severity] if severity else [])


def test_settings_of_several_numbers_are_taken_back_number_by_number(workshop: Workshop) -> None:
    base = model('solreflimit=".01"', FLEX + ARM)
    found = workshop.link(base, Piece(model("", ARM), "p/")).model()
    alone = workshop.link(model("", ARM), Piece(model("", ARM), "p/")).model()
    assert found.joint("p/j").solref.tolist() == alone.joint("p/j").solref.tolist()
    assert undo_settings({"solreflimit": ".01"}) == {"solreflimit": "0.02"}
