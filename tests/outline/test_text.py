from __future__ import annotations

import re

from composer.numerics.pose import Pose
from composer.outline.data import as_data
from composer.outline.outline import Body, Joint, Outline, Part, Place
from composer.outline.text import render, render_places

TURN = Pose((0.1, 0, 1 / 3), (0, 1, 0, 0))
HAND = Body("hand/palm", "hand", (Joint("a", "slide", (-0.1, 0.1)), Joint(None, "hinge", (-1, 0.5))),
            (Place("site", "12", Pose(), TURN), Place("frame", "hand/f", Pose(), Pose())))  # fmt: skip
ARM = Body(
    "arm",
    "base",
    (Joint("pan", "free"),),
    (Place("body", "arm", Pose(), Pose()),),
    (HAND, Body(None, None, copies=4)),
)
ROBOT = Outline(
    "robot",
    "robot.yaml",
    Body("world", None, children=(ARM,)),
    (Part("base", "arm.xml"), Part("hand", "hand.xml", "arm")),
)


def test_the_tree() -> None:
    assert render(ROBOT).splitlines() == [
        "robot: 3 bodies, 3 joints, 2 parts",
        "  base  arm.xml",
        "  hand  hand.xml, on arm",
        "world",
        "└ arm   pan free",
        "  ├ hand/palm [hand]   a slide ±0.1 m, hinge -57.3…28.6°",
        "  └ (no name) ×4",
    ]


def test_depth_says_what_it_hides() -> None:
    assert render(ROBOT, 1).splitlines()[-2:] == ["└ arm   pan free", "  └ … 2 bodies, 2 joints below"]
    assert render(ROBOT, 2) == render(ROBOT)
    assert [each["name"] for each in as_data(ROBOT, 1)["bodies"]] == ["world", "arm"]


def test_places_are_lines_to_paste() -> None:
    lines = render_places(ROBOT).splitlines()
    assert [line.split()[:2] for line in lines[1:]] == [
        ["site:", '"12"'],
        ["frame:", "hand/f"],
        ["body:", "arm"],
    ]
    assert lines[1].split()[4:] == ["0.1", "0", "0.3333", "0", "1", "0", "0"]
    assert len(render_places(ROBOT, 1).splitlines()) == 2
    assert "nothing with a name" in render_places(Outline("x", "x.xml", Body("world", None)))


def test_colors_go_around_the_same_text() -> None:
    for paint in (render, render_places):
        colored = paint(ROBOT, None, True)
        assert colored != paint(ROBOT) and re.sub(r"\x1b\[[\d;]*m", "", colored) == paint(ROBOT)
