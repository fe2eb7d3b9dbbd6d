from __future__ import annotations

import pytest
from link.workshop import BASE, Piece, Workshop, hinge, placed

from composer.link import root_rules

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
    assert "weld" in (fault.help or "")


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
    pieces = [
        Piece(floor, "floor/", placed("site", "arm/flange")),
        Piece(ARM, "arm/", placed(pos=(1.0, 0.0, 0.0))),
    ]
    assert workshop.link("<mujoco/>", *pieces).fault.code == "plane-on-body"


def test_all_that_is_wrong_with_the_places_is_told_at_once(workshop: Workshop) -> None:
    linked = workshop.link(
        ARM,
        Piece(part(FREE["freejoint"]), "a/", placed("site", "flange")),
        Piece(part(MOCAP), "b/", placed("site", "flange")),
        Piece(BASE, "c/", placed("site", "nowhere")),
    )
    assert linked.codes == ["attach-place", "freejoint-on-body", "mocap-on-body"]


def test_what_is_looked_at_grows_with_the_free_bodies(
    workshop: Workshop, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks = []
    plain = root_rules.through_frames
    monkeypatch.setattr(
        root_rules, "through_frames", lambda node: (looks.append(1) or each for each in plain(node))
    )

    def looked(count: int) -> int:
        looks.clear()
        loose = "".join(f'<body name="b{n}"><freejoint/><geom size=".1"/></body>' for n in range(count))
        workshop.link(ARM, Piece(part(loose)))
        return len(looks)

    assert looked(80) < 2.5 * looked(40)
