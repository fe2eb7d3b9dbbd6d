from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest
from link.workshop import BASE, Piece, Workshop, hinge, placed
from mjcompose.base.rotation import Pose, normalize, rotate
from mjcompose.link import world
from mjcompose.link.linking import AttachmentPlace, Joint
from mjcompose.mujoco.match import Mount
from mjcompose.mujoco.unchanged import compare

ARM = """<mujoco model="arm"><worldbody><body name="still"><geom size=".1"/>
  <body name="link"><joint name="j"/><geom size=".1"/><site name="flange"/></body><site name="foot"/></body>
  <body name="hand" mocap="true"><site name="palm"/></body></worldbody></mujoco>"""
FREE = {
    "freejoint": '<body name="cube"><freejoint/><geom size=".1"/></body>',
    "typed": '<body name="cube"><joint type="free"/><geom size=".1"/></body>',
    "by class": '<body name="cube" childclass="loose"><joint/><geom size=".1"/></body>',
    "in a frame": '<frame pos="1 0 0"><body name="cube"><frame><freejoint/></frame><geom size=".1"/></body></frame>',
}
MOCAP = '<body name="hoop" mocap="true"><geom size=".1"/></body>'


def part(worldbody: str) -> str:
    return f"""<mujoco><default><default class="loose"><joint type="free"/></default></default>
      <worldbody>{worldbody}<body name="other"><joint/><geom size=".1"/></body></worldbody></mujoco>"""


@pytest.mark.parametrize("body", FREE.values(), ids=FREE.keys())
def test_a_free_body_stays_free_in_the_world(workshop: Workshop, body: str) -> None:
    model = workshop.link(ARM, Piece(part(body), place=placed(pos=(1.0, 2.0, 3.0)))).check()
    assert model.body("part/cube").dofnum == 6


@pytest.mark.parametrize("body", FREE.values(), ids=FREE.keys())
@pytest.mark.parametrize(("kind", "name"), [("site", "flange"), ("body", "still"), ("site", "foot")])
def test_a_free_body_cannot_hang_on_a_body(workshop: Workshop, body: str, kind: str, name: str) -> None:
    linked = workshop.link(ARM, Piece(part(body), place=placed(kind, name)))
    fault = linked.fault
    assert fault.code == "freejoint-on-body"
    assert fault.span is not None
    assert fault.span.file == "recipe.yaml"
    assert [note.span.file for note in fault.notes if note.span] == [str(linked.paths[1])]
    assert "joint: none" in (fault.help or "")


@pytest.mark.parametrize("body", [*FREE.values(), MOCAP], ids=[*FREE.keys(), "mocap"])
@pytest.mark.parametrize(("kind", "name"), [("site", "top"), ("frame", "corner")])
def test_a_place_of_the_world_is_the_world(workshop: Workshop, body: str, kind: str, name: str) -> None:
    base = """<mujoco><worldbody><site name="top" pos="1 2 3"/>
      <frame pos="1 0 0"><frame name="corner" pos="0 2 3"/></frame></worldbody></mujoco>"""
    model = workshop.link(base, Piece(part(body), place=placed(kind, name))).model()
    moved = "part/hoop" if "mocap" in body else "part/cube"
    assert model.body(moved).parentid == 0
    assert model.body(moved).pos.tolist() == ([1, 2, 3] if "pos" not in body else [2, 2, 3])


@pytest.mark.parametrize("body", FREE.values(), ids=FREE.keys())
def test_a_free_body_can_be_welded(workshop: Workshop, body: str) -> None:
    piece = Piece(part(body), place=placed("site", "flange"), options={"weld": True})
    model = workshop.link(ARM, piece).model()
    assert model.body("part/cube").dofnum == 0
    assert model.body("part/other").dofnum == 1
    assert model.body("part/cube").parentid == model.body("link").id


def test_a_welded_part_may_stand_in_the_world(workshop: Workshop) -> None:
    model = workshop.link(ARM, Piece(part(FREE["freejoint"]), options={"weld": True})).model()
    assert model.body("part/cube").dofnum == 0


def test_below_a_joint_of_its_own_a_part_cannot_be_free(workshop: Workshop) -> None:
    piece = Piece(part(FREE["freejoint"]), "cube/", options={"joints": (hinge(name="cube/"),)})
    assert workshop.link(ARM, piece).fault.code == "freejoint-on-body"
    piece = Piece(part(FREE["freejoint"]), "cube/", options={"mocap": True})
    assert workshop.link(ARM, piece).fault.code == "freejoint-on-body"


def test_a_mocap_body_stays_one_in_the_world(workshop: Workshop) -> None:
    model = workshop.link(ARM, Piece(part(MOCAP), place=placed(pos=(0.0, 0.0, 1.0)))).check()
    assert model.nmocap == 2


@pytest.mark.parametrize("options", [{}, {"weld": True}])
def test_a_mocap_body_cannot_hang_on_a_body(workshop: Workshop, options: dict[str, object]) -> None:
    piece = Piece(part(MOCAP), place=placed("body", "still"), options=options)
    linked = workshop.link(ARM, piece)
    assert linked.fault.code == "mocap-on-body"
    assert [note.span.file for note in linked.fault.notes if note.span] == [str(linked.paths[1])]


def test_a_mocap_body_cannot_hang_on_a_mocap_body(workshop: Workshop) -> None:
    assert workshop.link(ARM, Piece(part(MOCAP), options={"mocap": True})).fault.code == "mocap-on-body"


PLANE = '<geom name="floor" type="plane" size="1 1 1"/>'


@pytest.mark.parametrize(
    "plane",
    [
        PLANE,
        f"<frame>{PLANE}</frame>",
        '<geom name="floor" class="floor"/>',
        f'<body name="table"><body name="top">{PLANE}</body></body>',
    ],
)
def test_a_plane_needs_something_that_stands_still(workshop: Workshop, plane: str) -> None:
    text = f"""<mujoco><default><default class="floor"><geom type="plane" size="1 1 1"/></default></default>
      <worldbody>{plane}</worldbody></mujoco>"""
    for place in (placed(pos=(0.0, 0.0, 1.0)), placed("body", "still"), placed("site", "foot")):
        workshop.link(ARM, Piece(text, place=place)).check()
    for place in (placed("body", "link"), placed("site", "flange"), placed("site", "palm")):
        linked = workshop.link(ARM, Piece(text, place=place))
        assert linked.fault.code == "plane-on-body"
        assert [note.span.file for note in linked.fault.notes if note.span] == [str(linked.paths[1])]
    for options in ({"joints": (hinge(name="part/"),)}, {"mocap": True}):
        assert workshop.link(ARM, Piece(text, options=options)).fault.code == "plane-on-body"


def test_a_plane_on_a_part_that_moves_is_told(workshop: Workshop) -> None:
    floor = f"<mujoco><worldbody>{PLANE}</worldbody></mujoco>"
    pieces = [Piece(floor, "floor/", placed("site", "arm/flange")), Piece(ARM, "arm/", placed(pos=(1.0, 0.0, 0.0)))]
    assert workshop.link("<mujoco/>", *pieces).fault.code == "plane-on-body"


def test_all_that_is_wrong_with_the_places_is_told_at_once(workshop: Workshop) -> None:
    linked = workshop.link(
        ARM,
        Piece(part(FREE["freejoint"]), "a/", placed("site", "flange")),
        Piece(part(MOCAP), "b/", placed("site", "flange")),
        Piece(BASE, "c/", placed("site", "nowhere")),
    )
    assert linked.codes == ["attach-place", "freejoint-on-body", "mocap-on-body"]


def test_what_is_looked_at_grows_with_the_free_bodies(workshop: Workshop, monkeypatch: pytest.MonkeyPatch) -> None:
    looks = []
    plain = world.through_frames
    monkeypatch.setattr(world, "through_frames", lambda node: (looks.append(1) or each for each in plain(node)))

    def looked(count: int) -> int:
        looks.clear()
        loose = "".join(f'<body name="b{n}"><freejoint/><geom size=".1"/></body>' for n in range(count))
        workshop.link(ARM, Piece(part(loose)))
        return len(looks)

    assert looked(80) < 2.5 * looked(40)


PARTS = """
<mujoco>
  <!-- a comment -->
  <contact><exclude name="e" body1="world" body2="b"/></contact>
  <worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><motor name="m1" joint="j"/></actuator>
  <sensor><clock name="s1"/></sensor>
  <actuator><!-- another --><motor name="m2" joint="j"/></actuator>
  <custom><text name="t" data="x"/></custom>
  <sensor><jointpos name="s2" joint="j"/></sensor>
</mujoco>
"""
PID = """<mujoco><extension><plugin plugin="mujoco.pid"><instance name="{name}"><config key="kp" value="{kp}"/></instance>
  </plugin></extension><worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><plugin joint="j" instance="{name}"/></actuator></mujoco>"""


def test_elements_follow_those_of_the_base_in_their_order(workshop: Workshop) -> None:
    model = workshop.link(PARTS, Piece(PARTS, "a/"), Piece(PARTS, "b/")).check()
    actuators = [model.actuator(at).name for at in range(model.nu)]
    assert actuators == ["m1", "m2", "a/m1", "a/m2", "b/m1", "b/m2"]
    assert [model.sensor(at).name for at in range(3)] == ["s1", "s2", "a/s1"]


def test_sections_that_the_base_lacks_are_made(workshop: Workshop) -> None:
    workshop.link("<mujoco/>", PARTS).check()


def test_of_several_sections_of_the_base_the_last_is_added_to(workshop: Workshop) -> None:
    linked = workshop.link(PARTS, PARTS.replace("m2", "m3"))
    first, last = linked.linking.base.root.findall("actuator")
    assert [element.get("name") for element in first] == ["m1"]
    assert [element.get("name") for element in last.iterchildren("*")] == ["m2", "part/m1", "part/m3"]


def test_a_plugin_is_declared_once(workshop: Workshop) -> None:
    linked = workshop.link(
        PID.format(name="one", kp=1),
        Piece(PID.format(name="one", kp=2), "a/"),
        Piece(PID.format(name="two", kp=3), "b/"),
    )
    linked.check()
    assert linked.xml.count('<plugin plugin="mujoco.pid">') == 1
    instances = [instance.get("name") for instance in linked.linking.base.root.iter("instance")]
    assert instances == ["one", "a/one", "b/two"]


def test_a_plugin_that_the_base_lacks_is_declared(workshop: Workshop) -> None:
    workshop.link(BASE, Piece(PID.format(name="one", kp=2), "a/"), Piece(PID.format(name="one", kp=3), "b/")).check()


@pytest.mark.parametrize("tag", ["motor", "jointpos", "text", "exclude", "instance"])
def test_what_moved_is_told_from_its_own_file(workshop: Workshop, tag: str) -> None:
    included = PARTS.replace("<mujoco>", "<mujocoinclude>").replace("</mujoco>", "</mujocoinclude>")
    plugin = PID.format(name="p", kp=1).split("<worldbody>")[0].removeprefix("<mujoco>")
    part = f'<mujoco>{plugin}\n<include file="sub/i.xml"/></mujoco>'
    linked = workshop.link(PID.format(name="q", kp=1), Piece(part, files={"sub/i.xml": included}))
    base = linked.linking.base
    found = [element for element in base.root.iter(tag) if str(element.get("name")).startswith("part/")]
    assert found
    folder = linked.paths[1].parent
    for element in found:
        expected = linked.paths[1] if tag == "instance" else folder / "sub" / "i.xml"
        span = linked.linking.span(base, element)
        assert span.file == str(expected)
        line = expected.read_text().splitlines()[span.line - 1]
        assert line[span.column - 1 :].startswith(f"<{tag}")


# -- the part's world -------------------------------------------------------------------------------------------

TOP = """<mujoco><option gravity="{gravity}" timestep="0.002"><flag contact="disable"/></option>
  <worldbody>
    <geom size=".05"/><site name="here" pos=".1 .2 .3" euler="10 20 30"/>
    <body name="a" pos=".4 .1 1" euler="20 0 5">{joint}<geom type="box" size=".1 .05 .02" pos=".1 .05 .03"/><site name="of_a" pos=".1 0 0"/>
      <body name="c" pos="0 0 .2"><joint axis="1 0 0" damping=".01"/><geom size=".04" pos=".1 .05 0"/></body>
    </body>
  </worldbody>
  <equality>{equality}</equality>
</mujoco>"""
TURNED = 'relpose="-.3 .2 -.9 .9 .1 -.2 .3"'
EQUALITIES = [
    '<weld body1="a"/>',
    '<weld body1="a" body2="world" anchor=".2 -.1 .4" torquescale=".3"/>',
    f'<weld body1="a" {TURNED}/>',
    f'<weld body1="a" {TURNED} anchor=".2 -.1 .4"/>',
    '<weld body1="a" relpose="5 5 5 0 0 0 0" anchor=".2 0 0"/>',
    f'<weld body1="world" body2="a" {TURNED}/>',
    f'<weld body1="world" body2="c" {TURNED} anchor=".05 .1 0"/>',
    '<weld body1="world" body2="a" anchor=".05 .1 0"/>',
    '<connect body1="a" anchor=".05 .1 0"/>',
    '<connect body1="c" body2="world" anchor=".05 .1 0"/>',
    '<connect body1="world" body2="c" anchor=".4 .1 1.3"/>',
    '<connect site1="of_a" site2="here"/>',
    '<weld site1="here" site2="of_a"/>',
]
POSE = Pose((3.0, -1.0, 0.5), normalize((0.8, 0.3, -0.2, 0.4)))
SECTIONS_FREE = "<freejoint/>"
HINGE = '<joint axis="0 1 0" damping=".02"/>'
CART = """<mujoco><worldbody><body name="cart" pos="0 1 0" euler="0 0 40"><joint type="slide" axis="1 0 0"/>
  <joint type="hinge" axis="0 1 1"/><geom size=".1" mass="5"/>
  <frame euler="0 50 0"><site name="deck" pos=".1 .2 .3" euler="15 0 0"/></frame></body></worldbody></mujoco>"""


def follows(alone: mujoco.MjModel, composed: mujoco.MjModel, pose: Pose, seconds: float) -> None:
    """The part moves as it does alone, in a world that is moved by `pose`; it starts at another pose than the reference."""
    mine = mujoco.MjData(alone)
    theirs = mujoco.MjData(composed)
    for data in (mine, theirs):
        data.qpos[-1] += 0.2
        data.qvel[-1] = 0.4
    for _ in range(round(seconds / 0.002)):
        mujoco.mj_step(alone, mine)
        mujoco.mj_step(composed, theirs)
    for body in range(1, alone.nbody):
        there = composed.body("part/" + alone.body(body).name).id
        x, y, z = mine.xpos[body].tolist()
        assert theirs.xpos[there] == pytest.approx((pose @ Pose((x, y, z))).pos, abs=1e-6)
    assert mine.nefc == theirs.nefc
    assert np.linalg.norm(theirs.efc_force) == pytest.approx(np.linalg.norm(mine.efc_force), rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("joint", [SECTIONS_FREE, HINGE])
@pytest.mark.parametrize("equality", EQUALITIES)
def test_an_equality_with_the_world_moves_with_its_part(workshop: Workshop, equality: str, joint: str) -> None:
    """The part alone is the judge, for 2 s, where gravity points the same way."""
    down = rotate(POSE.quat, (0.5, 0.0, -9.81))
    text = TOP.format(gravity="0.5 0 -9.81", joint=joint, equality=equality)
    composed = workshop.link(BASE, Piece(text, place=placed(pos=POSE.pos, quat=POSE.quat))).check()
    composed.opt.gravity[:] = down
    follows(mujoco.MjModel.from_xml_string(text), composed, POSE, 2.0)


@pytest.mark.parametrize("equality", EQUALITIES)
@pytest.mark.parametrize("piece", [{}, {"joints": (Joint("joint", {"name": "lift", "type": "slide"}),)}])
def test_below_a_body_its_world_is_that_body(workshop: Workshop, equality: str, piece: dict[str, Any]) -> None:
    """Wherever that body is, the residuals are those of the part alone."""
    text = TOP.format(gravity="0 0 0", joint=HINGE, equality=equality)
    at = placed("site", "deck", pos=(0.1, 0.0, 0.2), quat=POSE.quat)
    composed = workshop.link(CART, Piece(text, place=at, options=piece)).check()
    alone = mujoco.MjModel.from_xml_string(text)
    mine = mujoco.MjData(alone)
    theirs = mujoco.MjData(composed)
    for turns in ([0.3, -0.4], [1.1, 0.7]):
        mine.qpos[:] = theirs.qpos[-2:] = turns
        theirs.qpos[:-2] = np.array([0.7, -0.5, 0.3])[: composed.nq - 2]
        for model, data in ((alone, mine), (composed, theirs)):
            mujoco.mj_forward(model, data)
        residuals = [
            np.linalg.norm(data.efc_pos[data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)])
            for data in (mine, theirs)
        ]
        assert residuals[0] > 1e-3 and residuals[1] == pytest.approx(residuals[0])


def test_attached_twice_it_moves_twice(workshop: Workshop) -> None:
    """A composition is a part as any other: what was carried once is carried on."""
    text = TOP.format(gravity="0 0 0", joint=SECTIONS_FREE, equality="".join(EQUALITIES[2:7]))
    inner = workshop.link(BASE, Piece(text, place=placed("site", "mark", quat=POSE.quat)))
    outer = workshop.link("<mujoco/>", Piece(inner.xml, "", place=placed(pos=POSE.pos, quat=POSE.quat)))
    place = POSE @ Pose((1, 2, 3), POSE.quat)
    direct = workshop.link(BASE, Piece(text, place=placed(pos=place.pos, quat=place.quat)))
    quats = [np.abs(model.check().eq_data[:, 6:10]) for model in (outer, direct)]
    assert quats[0] == pytest.approx(quats[1])
    assert outer.check().eq_data[:, :6] == pytest.approx(direct.check().eq_data[:, :6])


NAMING = """<mujoco><worldbody><geom size=".1"/><body name="b" pos=".15 0 0"><joint type="slide" axis="1 0 0"/>
    <geom size=".1"/></body><camera name="eye" pos="0 0 1" mode="targetbody" target="world"/></worldbody>
  <contact><exclude name="e" body1="world" body2="b"/></contact>
  <sensor><framepos name="p" objtype="body" objname="b" reftype="body" refname="world"/>
    <distance name="d" body1="world" body2="b" cutoff="9"/></sensor>
  <custom><tuple name="t"><element objtype="body" objname="world" prm="1"/></tuple></custom></mujoco>"""


def test_targets_and_excludes_that_name_the_world_name_the_body_that_holds_it(workshop: Workshop) -> None:
    linked = workshop.link(CART, Piece(NAMING, place=placed("body", "cart")))
    model = linked.check()
    data = mujoco.MjData(model)
    data.qpos[:] = [0.4, 0.3, 0.1]
    mujoco.mj_forward(model, data)
    assert data.ncon == 0
    assert model.cam_targetbodyid[0] == model.body("cart").id
    assert 'body1="cart" body2="part/b"' in linked.xml
    assert not linked.linking.sink.diagnostics


@pytest.mark.parametrize("where", [placed("body", "cart"), placed("site", "deck", quat=(0.6, 0, 0, 0.8)), placed()])
def test_sensors_and_tuples_that_name_the_world_keep_it(workshop: Workshop, where: AttachmentPlace) -> None:
    """A sensor reads the same with the world as its reference as without a reference, alone and attached."""
    text = NAMING.replace("</sensor>", '<framepos name="free" objtype="body" objname="b"/></sensor>')
    linked = workshop.link(CART, Piece(text, place=where))
    model = linked.check()
    data = mujoco.MjData(model)
    data.qpos[:] = [0.4, 0.3, 0.1]
    mujoco.mj_forward(model, data)
    assert data.sensor("part/p").data == pytest.approx(data.sensor("part/free").data)
    assert data.sensor("part/p").data == pytest.approx(data.body("part/b").xipos)
    assert model.tuple_objid.tolist() == [0]
    assert 'body1="world"' in linked.xml


def test_in_the_world_the_world_keeps_its_name(workshop: Workshop) -> None:
    linked = workshop.link(
        BASE,
        Piece(
            NAMING.replace("<camera", "<!--").replace('"world"/></worldbody>', '"--></worldbody>'),
            place=placed(pos=(1, 0, 0)),
        ),
    )
    assert 'body1="world"' in linked.xml and 'refname="world"' in linked.xml
    linked.check()


@pytest.mark.parametrize(
    ("where", "code"), [((0, 0, 0), []), ((0, 0, 1), ["world-frame"])], ids=["at the origin", "moved"]
)
def test_who_looks_at_the_origin_of_a_moved_part_is_reported(
    workshop: Workshop, where: tuple[float, float, float], code: list[str]
) -> None:
    linked = workshop.link(BASE, Piece(NAMING, place=placed(pos=where)))
    assert [each.code for each in linked.linking.sink.diagnostics] == code


@pytest.mark.parametrize(
    ("base", "place", "words"),
    [
        (CART.replace('name="cart" ', ""), placed("site", "deck"), "has no name"),
        (
            '<mujoco><worldbody><replicate count="2" offset="1 0 0"><frame name="f"/></replicate></worldbody></mujoco>',
            placed("frame", "f"),
            "copies it",
        ),
    ],
)
def test_a_world_that_cannot_be_named_is_an_error(
    workshop: Workshop, base: str, place: AttachmentPlace, words: str
) -> None:
    text = TOP.format(gravity="0 0 0", joint=HINGE, equality=EQUALITIES[8])
    (fault,) = workshop.link(base, Piece(text, place=place)).linking.sink.errors
    assert fault.code == "attach-place" and words in fault.message and fault.span is not None


@pytest.mark.parametrize(
    ("transmission", "gear", "turn", "warns"),
    [
        ('joint="f"', "2 0 0", (0.6, 0, 0, 0.8), True),
        ('joint="f"', "0 0 3", (0.6, 0, 0, 0.8), False),  # turned about the axis along which it pushes
        ('joint="f"', "0 0 0 1 0 0", (0.6, 0, 0, 0.8), False),  # a free body is turned about its own axes
        ('jointinparent="f"', "0 0 0 1 0 0", (0.6, 0, 0, 0.8), True),
        ('joint="f" class="side"', "", (0.6, 0.8, 0, 0), True),
        ('joint="f"', "1 0 0", (1, 0, 0, 0), False),
        ('joint="h"', "1", (0.6, 0, 0, 0.8), False),
        ('site="s"', "1 0 0", (0.6, 0, 0, 0.8), False),
    ],
)
def test_a_motor_on_a_free_joint_pushes_along_the_world(
    workshop: Workshop, transmission: str, gear: str, turn: tuple[float, ...], warns: bool
) -> None:
    gear = f'gear="{gear}"' if gear else ""
    text = f"""<mujoco><default><default class="side"><motor gear="0 1 0"/></default></default>
      <worldbody><body><freejoint name="f"/><geom size=".1"/><site name="s"/>
      <body><joint name="h"/><geom size=".1" pos=".2 0 0"/></body></body></worldbody>
      <actuator><motor name="push" {transmission} {gear}/></actuator></mujoco>"""
    linked = workshop.link(BASE, Piece(text, place=placed(quat=turn)))  # type: ignore[arg-type]
    found = [each for each in linked.linking.sink.diagnostics if each.code == "world-frame"]
    assert bool(found) is warns
    # MuJoCo says so: in the part's own axes it is another force.
    forces = []
    for model, back in ((mujoco.MjModel.from_xml_string(text), (1.0, 0.0, 0.0, 0.0)), (linked.model(), turn)):
        data = mujoco.MjData(model)
        data.ctrl[:] = 1
        mujoco.mj_forward(model, data)
        forces.append(rotate((back[0], -back[1], -back[2], -back[3]), data.qfrc_actuator[:3]))
    if 'joint="f"' in transmission and "jointin" not in transmission:
        assert (forces[0] != pytest.approx(forces[1], abs=1e-9)) is warns


@pytest.mark.parametrize(("body", "told"), [("b", 1), ("c", 0)])
def test_what_mujoco_attaches_is_not_carried(workshop: Workshop, body: str, told: int) -> None:
    """Its equality would stay where it is in its own file, 3 m away."""
    sub = """<mujoco model="sub"><worldbody><body name="b"><joint/><geom size=".1"/></body>
      <body name="c"><joint/><geom size=".1"/></body></worldbody>
      <equality><connect name="pin" body1="world" body2="b" anchor="0 0 1"/></equality></mujoco>"""
    text = f"""<mujoco><asset><model name="s" file="s.xml"/></asset>
      <worldbody><body name="o"><attach model="s" body="{body}" prefix="q"/></body></worldbody></mujoco>"""
    assert not workshop.link(BASE, Piece(text, files={"s.xml": sub})).sink.diagnostics
    moved = workshop.link(BASE, Piece(text, place=placed(pos=(3, 0, 0)), files={"s.xml": sub}))
    assert [each.code for each in moved.sink.diagnostics] == ["not-supported"] * told
    twice = workshop.link(BASE, Piece(text, files={"s.xml": sub}))
    again = workshop.link(BASE, Piece(twice.xml, "n/", placed(pos=(3, 0, 0)), twice.bundled()))
    assert [each.code for each in again.sink.diagnostics] == ["not-supported"] * told


# -- derived numbers of degenerate poses ------------------------------------------------------------------------

SLACK = """<mujoco><worldbody><site name="w" pos="{away} .3 0"/>
  <body pos="0 .3 0"><joint axis="0 1 0"/><geom size=".2" pos="1 0 0"/><site name="s" pos="1 0 0"/></body></worldbody>
  <tendon><spatial name="t" damping="5"><site site="s"/><site site="w"/></spatial></tendon>
  <actuator><motor name="m" tendon="t"/></actuator></mujoco>"""
TILTED = normalize((0.9, 0.2, 0.1, -0.3))


def test_a_tendon_without_a_direction_is_unchanged(workshop: Workshop) -> None:
    """Its ends lie in one point: MuJoCo takes a direction of its own, by which what follows differs."""
    at = placed(pos=(1, 2, 3), quat=TILTED)
    model = workshop.link(BASE, Piece(SLACK.format(away=1), place=at)).check()
    alone = mujoco.MjModel.from_xml_string(SLACK.format(away=1))
    assert abs(alone.tendon_invweight0[0] - model.tendon_invweight0[0]) > 1e-5
    workshop.link(BASE, Piece(SLACK.format(away=1.01), place=at)).check()


@pytest.mark.mujoco4("it leaves flexes behind the frame around them")
def test_what_mujoco_does_not_turn_is_said(workshop: Workshop) -> None:
    flex = '<flexcomp name="c" type="grid" dim="2" count="3 3 1" spacing=".1 .1 .1" mass=".1" radius=".01"/>'
    text = f'<mujoco><worldbody>{flex}<body name="b" pos="0 0 9"><geom size=".1"/></body></worldbody></mujoco>'
    found = workshop.link(BASE, Piece(text, place=placed(quat=TILTED))).differences()
    assert found and {each.field for each in found} == {"body_quat"}
    assert all("vertices" in str(each) for each in found)


SOFT = """<mujoco><worldbody>{open}<flexcomp name="f" type="grid" dim="3" count="2 2 2" spacing=".1 .1 .1" mass="1"
  pos="0 0 1" radius=".01" dof="{dof}"><edge equality="true"/><contact selfcollide="none"/></flexcomp>{close}</worldbody></mujoco>"""


@pytest.mark.mujoco4("MuJoCo 3 leaves a flex where it is, and a build says so")
@pytest.mark.parametrize(
    ("dof", "pose", "words"),
    [
        ("full", POSE, ""),
        ("2d", POSE, "along the axes of the world"),
        ("2d", Pose(POSE.pos), ""),
        ("trilinear", POSE, "along the axes of the world"),
        ("trilinear", Pose(POSE.pos), ""),
        ("quadratic", POSE, "along the axes of the world"),
        ("radial", Pose(POSE.pos), "from the origin of the world"),
        ("radial", Pose(), ""),
    ],
)
def test_a_flex_that_mujoco_lays_out_by_other_axes_is_reported(
    workshop: Workshop, dof: str, pose: Pose, words: str
) -> None:
    """A warning stands exactly where the flex is another one; in a body of its own it never is."""
    for top, bottom in (("", ""), ('<body name="own">', "</body>")):
        text = SOFT.format(dof=dof, open=top, close=bottom)
        linked = workshop.link(BASE, Piece(text, place=placed(pos=pose.pos, quat=pose.quat)))
        told = [each.message for each in linked.linking.sink.diagnostics]
        assert len(told) == bool(words and not top) and words in "".join(told or [words])
        alone = mujoco.MjModel.from_xml_string(text)
        kept = compare(alone, linked.model(), prefix="part/", hung_on=Mount(None, pose), tolerance=1e-9)
        assert any(not each.why or dof == "2d" for each in kept) == bool(told)


@pytest.mark.parametrize("mocap", [False, True])
def test_several_free_bodies_start_at_a_place(workshop: Workshop, mocap: bool) -> None:
    """They are put into the world where MuJoCo computes the site of the arm, and their keys move along."""
    head, joint = ('mocap="true"', "") if mocap else ("", "<freejoint/>")
    two = f"""<body name="a" pos="0 0 0.1" {head}>{joint}<geom size=".1"/></body>
      <frame euler="0 0 90"><body name="b" pos="0.2 0 0" {head}>{joint}<geom size=".1"/></body></frame>"""
    numbers = "mpos='0 0 3 0 0 4'" if mocap else "qpos='0 0 3 1 0 0 0 0 0 4 1 0 0 0'"
    text = f"<mujoco><worldbody>{two}</worldbody><keyframe><key name='up' {numbers}/></keyframe></mujoco>"
    piece = Piece(text, place=placed("site", "flange"), options={"by_itself": True})
    arm = ARM.replace('<body name="link">', '<body name="link" pos="1 2 3" euler="0 90 0">')
    model = workshop.link(arm, piece).model()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    pos = data.site("flange").xpos.copy()
    turn = data.site("flange").xmat.reshape(3, 3).copy()
    for name, here in (("a", [0, 0, 0.1]), ("b", [0, 0.2, 0])):
        assert model.body(f"part/{name}").parentid == 0
        assert data.body(f"part/{name}").xpos == pytest.approx(pos + turn @ here)
    mujoco.mj_resetDataKeyframe(model, data, model.key("up").id)
    there = data.mocap_pos[-2:] if mocap else data.qpos[-14:].reshape(2, 7)[:, :3]
    assert there == pytest.approx(np.array([pos + turn @ [0, 0, 3], pos + turn @ [0, 0, 4]]))
