from __future__ import annotations

import itertools
import math
import re
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from link.workshop import BASE, Linked, Piece, Workshop, hinge, placed
from mjcompose.link.bodies import effective_pose
from mjcompose.link.linking import AttachmentPlace, Joint

ARM = """
<mujoco model="arm">
  <default><site euler="0 20 0"/>
    <default class="flange"><site pos="0 .2 .3" zaxis="1 1 1"/></default></default>
  <worldbody>
    <body name="link" pos="0 0 1" euler="10 20 30">
      <joint name="turn" axis="0 1 0"/><geom size=".1"/>
      <site name="plain"/>
      <site name="classed" class="flange"/>
      <site name="own" class="flange" quat="0 1 0 0"/>
      <site name="rod" type="capsule" size=".01" fromto="0 0 0 .1 .2 .3"/>
      <frame name="outer" pos=".1 0 0" axisangle="0 0 1 45">
        <site name="framed"/>
        <frame name="inner" euler="5 6 7"><geom size=".02"/><site name="deep" pos="1 0 0"/></frame>
      </frame>
      <frame childclass="flange"><site name="childclassed"/></frame>
    </body>
    <body name="still" pos="4 4 4" xyaxes="0 1 0 -1 0 0"/>
    <site name="there" pos="1 2 3"/>
    <frame name="spot" pos="7 7 7"></frame>
  </worldbody>
</mujoco>
"""
HAND = """
<mujoco model="hand"><default><joint damping="2"/></default><worldbody>
  <geom name="plate" size=".05" pos="0 0 .02"/><camera name="eye" pos="0 .1 0" euler="10 0 0"/><light name="lamp"/>
  <body name="finger" pos=".1 0 0" euler="0 45 0"><joint name="grip" type="slide"/><geom size=".02"/><site name="tip"/></body>
  <frame pos="0 1 0"><body name="thumb"><joint name="thumb"/><geom size=".02"/></body></frame>
</worldbody></mujoco>
"""
OFFSETS = [placed(), placed(pos=(0.1, 0.2, 0.3)), placed(pos=(0.0, 0.0, 1.0), quat=(0.5, 0.5, 0.5, -0.5))]
SITES = ["plain", "classed", "own", "rod", "framed", "deep", "childclassed", "there"]


def at(kind: str, name: str | None, offset: AttachmentPlace) -> AttachmentPlace:
    return AttachmentPlace(kind, name, offset.offset, offset.span)  # type: ignore[arg-type]


@pytest.mark.parametrize("site", SITES)
@pytest.mark.parametrize("offset", OFFSETS, ids=["", "moved", "turned"])
@pytest.mark.mujoco4("an orientation of the class wins over one of the element")
def test_a_part_on_a_site_stands_as_the_site_does(workshop: Workshop, site: str, offset: AttachmentPlace) -> None:
    linked = workshop.link(ARM, Piece(HAND, place=at("site", site, offset)))
    linked.check()


@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.mujoco4("an orientation of the class wins over one of the element")
def test_the_angles_of_a_site_are_read_in_the_unit_of_the_model(workshop: Workshop, angle: str) -> None:
    hand = HAND.replace("<default>", f'<compiler angle="{angle}"/><default>')
    for site in SITES:
        workshop.link(ARM, Piece(hand, place=placed("site", site))).check()


@pytest.mark.parametrize("body", ["link", "still"])
@pytest.mark.parametrize("offset", OFFSETS, ids=["", "moved", "turned"])
def test_a_part_on_a_body_stands_in_its_frame(workshop: Workshop, body: str, offset: AttachmentPlace) -> None:
    workshop.link(ARM, Piece(HAND, place=at("body", body, offset))).check()


def test_a_part_in_the_world_stands_at_its_offset(workshop: Workshop) -> None:
    for offset in OFFSETS:
        workshop.link(ARM, Piece(HAND, place=offset)).check()
    model = workshop.link(ARM, Piece(HAND, place=OFFSETS[1])).model()
    assert model.body("part/finger").pos == pytest.approx([0.2, 0.2, 0.3])


@pytest.mark.parametrize("frame", ["outer", "inner", "spot"])
def test_a_part_in_a_frame_stands_in_it(workshop: Workshop, frame: str) -> None:
    linked = workshop.link(ARM, Piece(HAND, place=placed("frame", frame, pos=(0.0, 0.0, 0.5))))
    model = linked.check()
    there = pose_of_frame(frame)
    assert model.geom("part/plate").pos == pytest.approx(there @ [0, 0, 0.52, 1], abs=1e-14)


def pose_of_frame(frame: str) -> np.ndarray:
    """The first three rows of the frame's matrix in its body, as MuJoCo has it."""
    points = ("0 0 0", "1 0 0", "0 1 0", "0 0 1")
    probes = "".join(f'<site name="probe{at}" pos="{point}" euler="0 0 0"/>' for at, point in enumerate(points))
    model = mujoco.MjModel.from_xml_string(re.sub(rf'<frame name="{frame}"[^>]*>', rf"\g<0>{probes}", ARM))
    origin, *axes = (model.site(f"probe{number}").pos for number in range(4))
    return np.column_stack([axis - origin for axis in axes] + [origin])


ORIENTATIONS = {
    "quat": 'quat="1 1 0 0"',
    "euler": 'euler="10 20 30"',
    "zaxis": 'zaxis="1 1 1"',
    "axisangle": 'axisangle="1 0 0 50"',
    "none": "",
}


@pytest.mark.parametrize("own", ORIENTATIONS)
@pytest.mark.mujoco4("an orientation of the class wins over one of the element")
def test_of_the_orientations_of_a_class_and_its_parent_the_nearest_counts(workshop: Workshop, own: str) -> None:
    for outer, inner in itertools.product(ORIENTATIONS.values(), repeat=2):
        base = f"""<mujoco><default>
          <default class="a"><site {outer} pos="1 2 3"/><default class="b"><site {inner}/></default></default></default>
          <worldbody><body><geom size=".1"/><site name="m" class="b" {ORIENTATIONS[own]}/></body></worldbody></mujoco>"""
        workshop.link(base, Piece(BASE, place=placed("site", "m"))).check()


@pytest.mark.parametrize(
    ("attributes", "expected"),
    [
        ('pos="1 2 3"', {"pos": "1 2 3"}),
        ('euler=""', {}),
        ('fromto="0 0 0 0 0 2"', {"pos": "0 0 1", "zaxis": "0 0 -2"}),
        ('fromto="nan nan nan nan nan nan" pos="1 0 0"', {"pos": "1 0 0"}),
    ],
)
def test_the_pose_of_a_site(workshop: Workshop, attributes: str, expected: dict[str, str]) -> None:
    unit = workshop.unit(f"<mujoco><worldbody><site {attributes}/></worldbody></mujoco>")
    assert effective_pose(unit.root.find("worldbody/site"), unit.classes) == expected


def test_parts_hang_on_parts_in_any_order(workshop: Workshop) -> None:
    pieces = [
        Piece(HAND, "c/", placed("body", "b/finger")),
        Piece(HAND, "b/", placed("site", "a/tip", pos=(0.0, 0.0, 1.0))),
        Piece(HAND, "d/", placed("site", "c/tip")),
        Piece(HAND, "a/", placed("site", "classed")),
    ]
    for order in itertools.permutations(pieces):
        model = workshop.link(ARM, *order).check()
        assert model.body("d/finger").parentid == model.body("c/finger").id


def test_parts_in_the_world_keep_their_order(workshop: Workshop) -> None:
    model = workshop.link(ARM, *(Piece(HAND, prefix) for prefix in ("z/", "a/", "m/"))).check()
    fingers = [model.body(f"{prefix}/finger").id for prefix in "zam"]
    assert fingers == sorted(fingers)


UNKNOWN = [
    ("site", "nowhere", "attach-place"),
    ("body", "part/finger", "attach-cycle"),
    ("body", "plain", "attach-place"),
    ("frame", "Outer", "attach-place"),
]


@pytest.mark.parametrize(("kind", "name", "code"), UNKNOWN)
def test_a_place_that_is_not_there_is_told(workshop: Workshop, kind: str, name: str, code: str) -> None:
    fault = workshop.link(ARM, Piece(HAND, place=placed(kind, name))).fault
    assert (fault.code, fault.span and fault.span.file) == (code, "recipe.yaml")
    assert ("part" if code == "attach-cycle" else name) in fault.message


def test_parts_that_hang_on_one_another_are_told(workshop: Workshop) -> None:
    ring = [
        Piece(HAND, "d/", placed("body", "a/thumb")),
        Piece(HAND, "a/", placed("body", "b/thumb")),
        Piece(HAND, "b/", placed("body", "a/thumb")),
    ]
    fault = workshop.link(ARM, *ring).fault
    assert fault.code == "attach-cycle"
    assert "`a` to `b` to `a`" in fault.message.replace("a/", "a").replace("b/", "b")


def test_a_near_name_or_another_kind_is_suggested(workshop: Workshop) -> None:
    assert "outer" in (workshop.link(ARM, Piece(HAND, place=placed("frame", "Outer"))).fault.help or "")
    assert "site: plain" in (workshop.link(ARM, Piece(HAND, place=placed("body", "plain"))).fault.help or "")


def test_what_hangs_on_a_part_without_a_place_is_not_told_too(workshop: Workshop) -> None:
    linked = workshop.link(
        ARM, Piece(HAND, "a/", placed("site", "nowhere")), Piece(HAND, "b/", placed("site", "a/tip"))
    )
    assert [fault.code for fault in linked.sink.errors] == ["attach-place"]


def joined(workshop: Workshop, place: AttachmentPlace, *joints: Joint) -> Linked:
    return workshop.link(ARM, Piece(HAND, "hand/", place, options={"joints": joints}))


JOINTS = {
    "hinge": (hinge(name="hand/a", axis="0 1 0", range="-30 30"),),
    "ball": (Joint("joint", {"name": "hand/", "type": "ball", "class": "main"}),),
    "three": tuple(
        Joint("joint", {"name": f"hand/{axis}", "type": "slide", "axis": axis, "class": "main"})
        for axis in ("1 0 0", "0 1 0", "0 0 1")
    ),
}


@pytest.mark.parametrize("joints", JOINTS.values(), ids=JOINTS.keys())
@pytest.mark.parametrize("place", [placed(), placed("site", "classed", pos=(0.1, 0.0, 0.0)), placed("body", "still")])
def test_joints_stand_between_a_place_and_a_part(
    workshop: Workshop, joints: tuple[Joint, ...], place: AttachmentPlace
) -> None:
    linked = joined(workshop, place, *joints)
    model = linked.check()
    body = model.body("hand/")
    assert body.jntnum == len(joints)
    assert model.geom("hand/plate").bodyid == body.id
    assert model.dof_damping[body.dofadr[0]] == 0, "the classes of neither side reach it"


def test_a_free_part_stands_in_the_world_where_its_place_is(workshop: Workshop) -> None:
    joint = Joint("freejoint", {"name": "hand/"})
    for place in (placed("site", "deep", pos=(0.1, 0.2, 0.3)), placed("body", "link"), placed("frame", "inner")):
        fixed = workshop.link(ARM, Piece(HAND, "hand/", place)).model()
        free = joined(workshop, place, joint).check()
        assert free.body("hand/").parentid == 0
        assert where(free, "hand/plate") == pytest.approx(where(fixed, "hand/plate"), abs=1e-14)


def test_a_mocap_part_stands_in_the_world_where_its_place_is(workshop: Workshop) -> None:
    place = placed("site", "deep", pos=(0.1, 0.2, 0.3), quat=(0.5, 0.5, 0.5, 0.5))
    still = HAND.replace('<joint name="grip" type="slide"/>', "").replace('<joint name="thumb"/>', "")
    fixed = workshop.link(ARM, Piece(still, "hand/", place)).model()
    model = workshop.link(ARM, Piece(still, "hand/", place, options={"mocap": True})).check()
    assert model.body("hand/").mocapid == 0
    assert where(model, "hand/plate") == pytest.approx(where(fixed, "hand/plate"), abs=1e-14)


@pytest.mark.parametrize("bounds", ['boundmass=".5"', 'boundinertia=".01"'])
@pytest.mark.parametrize("options", [{"mocap": True}, {"joints": (hinge(),)}])
def test_the_body_of_an_attachment_has_the_least_mass_of_the_base(
    workshop: Workshop, bounds: str, options: dict[str, Any]
) -> None:
    """MuJoCo gives it to every body of the base, those without a mass of their own, too."""
    base = f'<mujoco><compiler {bounds}/><worldbody><body name="empty"/></worldbody></mujoco>'
    part = '<mujoco><worldbody><body name="b"><geom size=".1"/></body></worldbody></mujoco>'
    linked = workshop.link(base, Piece(part, "p/", options=options))
    made = linked.model().body("p/")
    empty = linked.alone(0).body("empty")
    assert made.mass == empty.mass and made.inertia.tolist() == empty.inertia.tolist()
    assert made.mass[0] or made.inertia.all()


def where(model: mujoco.MjModel, geom: str) -> list[float]:
    """Position and axes of a geom in the world."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return [*data.geom(geom).xpos, *data.geom(geom).xmat]


def test_a_part_on_the_body_that_an_attachment_makes(workshop: Workshop) -> None:
    tool = Piece(HAND, "tool/", placed("body", "hand/"))
    hand = Piece(HAND, "hand/", placed("site", "plain"), options={"joints": JOINTS["hinge"]})
    model = workshop.link(ARM, tool, hand).check()
    assert model.body("tool/finger").parentid == model.body("hand/").id


def test_a_part_without_bodies_hangs_nowhere(workshop: Workshop) -> None:
    linked = workshop.link(ARM, Piece('<mujoco><asset><material name="m"/></asset></mujoco>'))
    assert 'childclass="part/"' not in linked.xml
    linked.check()


def test_several_world_bodies_of_a_part_hang_together(workshop: Workshop) -> None:
    part = """<mujoco><worldbody><body name="a"><geom size=".1"/></body></worldbody>
      <worldbody><site name="s"/></worldbody></mujoco>"""
    workshop.link(part, Piece(part, place=placed("body", "a"))).check()


def test_elements_that_moved_are_told_from_their_own_files(workshop: Workshop) -> None:
    part = '<mujoco>\n<include file="i.xml"/>\n<worldbody>\n<body name="own"/></worldbody></mujoco>'
    included = '<mujocoinclude>\n\n<worldbody>\n\n<body name="theirs"/>\n</worldbody></mujocoinclude>'
    linked = workshop.link(ARM, Piece(part, place=placed("body", "link"), files={"i.xml": included}))
    base = linked.linking.base
    spans = {
        str(body.get("name")): linked.linking.span(base, body) for body in base.root.iter("body") if body.get("name")
    }
    folder = linked.paths[1].parent
    assert (spans["part/theirs"].file, spans["part/theirs"].line) == (str(folder / "i.xml"), 5)
    assert (spans["part/own"].file, spans["part/own"].line) == (str(linked.paths[1]), 4)
    assert spans["link"].file == str(linked.paths[0])


def test_what_an_attachment_makes_is_told_from_the_recipe(workshop: Workshop) -> None:
    linked = joined(workshop, placed("site", "plain"), *JOINTS["hinge"])
    body = linked.linking.names.find("body", "hand/")
    assert body is not None
    assert linked.linking.span(linked.linking.base, body).file == "recipe.yaml"


FLOATS = st.floats(-3, 3).map(lambda number: round(number, 6))
POSES = st.tuples(
    st.tuples(FLOATS, FLOATS, FLOATS),
    st.tuples(FLOATS, FLOATS, FLOATS, FLOATS).filter(lambda quat: math.hypot(*quat) > 0.1),
)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.lists(POSES, min_size=1, max_size=4), st.lists(POSES, min_size=1, max_size=3))
def test_random_places_on_random_places(
    tmp_path_factory: pytest.TempPathFactory,
    offsets: list[tuple[tuple[float, float, float], tuple[float, float, float, float]]],
    sites: list[tuple[tuple[float, float, float], tuple[float, float, float, float]]],
) -> None:
    """Each part hangs on a site of the one before it; where it comes to stand is multiplied out by MuJoCo."""
    workshop = Workshop(tmp_path_factory.mktemp("places"))
    text = "".join(
        f'<site name="s{number}" pos="{" ".join(map(repr, pos))}" quat="{" ".join(map(repr, quat))}"/>'
        for number, (pos, quat) in enumerate(sites)
    )
    part = f'<mujoco><worldbody><body name="b" pos="0 0 1">{text}<geom name="g" size=".1"/></body></worldbody></mujoco>'
    pieces = []
    for number, (pos, quat) in enumerate(offsets):
        host = f"p{number - 1}/" if number else ""
        site = f"{host}s{number % len(sites)}"
        pieces.append(Piece(part, f"p{number}/", placed("site", site, pos=pos, quat=quat)))
    workshop.link(part, *pieces).check()
