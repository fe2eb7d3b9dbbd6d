from __future__ import annotations

import pytest
from link.workshop import BASE, OLDER, Piece, Workshop, placed

CLOCK = "<mujoco><worldbody/><sensor><clock/></sensor></mujoco>"
ROWS = {
    "one axis": '<replicate count="3" offset="1 0 .1" euler="0 0 40"{}><geom name="g" size=".1"/><site name="s"/></replicate>',
    "several axes": '<replicate count="12" offset="1 0 0" euler="10 20 30" sep="_"{}><geom size=".1" name="g"/></replicate>',
    "bodies": """<replicate count="2" offset="1 0 0"{}><body name="b" childclass="c"><freejoint name="f"/>
      <geom name="g" size=".1"/><camera name="k" mode="targetbody" target="b"/></body></replicate>""",
    "in a row": """<replicate count="2" offset="1 0 0"{} euler="0 30 0"><replicate count="3" offset="0 1 0" sep="-"><geom name="g"
      size=".1"/></replicate><body name="b"><joint name="j"/><geom name="h" size=".1"/></body></replicate>""",
    "no names": '<replicate count="2"{}><geom size=".1"/></replicate>',
}


def model(row: str, settings: str = "", more: str = "") -> str:
    return f"""<mujoco><compiler {settings}/><default><default class="c"><geom rgba="1 0 0 1"/></default></default>
      <worldbody><body name="host" pos="1 2 3" euler="1 2 3">{row if "freejoint" not in row else ""}<geom size=".1"/></body>
      {row if "freejoint" in row else ""}</worldbody>{more}</mujoco>"""


@pytest.mark.parametrize("settings", ['angle="degree"', 'angle="radian" eulerseq="XyZ"'])
@pytest.mark.parametrize("childclass", ["", ' childclass="c"'])
@pytest.mark.parametrize("row", ROWS.values(), ids=ROWS.keys())
def test_copies_are_what_mujoco_makes_of_them(
    workshop: Workshop, row: str, childclass: str, settings: str
) -> None:
    text = model(row.format(childclass), settings)
    for linked in (
        workshop.link(CLOCK, Piece(text, "p/", placed(pos=(0.0, 5.0, 0.0)))),
        workshop.link(text, Piece(CLOCK, "p/")),
    ):
        assert "<replicate" not in linked.xml
        linked.check()


def test_several_axes_in_another_sequence_are_written_out(workshop: Workshop) -> None:
    linked = workshop.link(BASE, model(ROWS["several axes"].format(""), 'eulerseq="zyx"'))
    assert "<replicate" not in linked.xml
    linked.check()


@pytest.mark.parametrize("count", [1, 9, 10, 11, 99, 100])
def test_copies_are_numbered_as_by_mujoco(workshop: Workshop, count: int) -> None:
    row = f'<replicate count="{count}" offset="1 0 0"><geom name="g" size=".1"/></replicate>'
    linked = workshop.link(CLOCK, model(row))
    assert "<replicate" not in linked.xml
    linked.check()


@pytest.mark.parametrize(("euler", "written_out"), [("0 0 30", True), ("0 0 45", False)])
@pytest.mark.parametrize("count", [2, 12])
def test_multiples_of_degrees_are_those_of_degrees(
    workshop: Workshop, euler: str, written_out: bool, count: int
) -> None:
    """`5 * 30` degrees in radians are not 5 times 30 degrees in radians."""
    spokes = f'<replicate count="{count}" euler="{euler}"><geom size=".1" pos=".3 0 0"/></replicate>'
    base = '<mujoco><compiler angle="radian"/></mujoco>'
    linked = workshop.link(base, model(f'<body name="b"><joint/>{spokes}</body>', ""))
    linked.check()
    assert ("<replicate" not in linked.xml) == (written_out and count > 5)


@pytest.mark.skipif(OLDER, reason="MuJoCo 3 copies keys with a replicate")
def test_keys_of_what_is_written_out(workshop: Workshop) -> None:
    numbers = " ".join(["1 2 3 1 0 0 0", "4 5 6 0 1 0 0"])
    key = f'<keyframe><key name="home" qpos="{numbers}"/></keyframe>'
    text = model(ROWS["bodies"].format(""), more=key)
    workshop.link(CLOCK, Piece(text, "p/", placed(pos=(0.0, 5.0, 0.0)))).check()


@pytest.mark.parametrize("row", [ROWS["one axis"], ROWS["several axes"]])
def test_what_changes_nothing_stays_as_it_is(workshop: Workshop, row: str) -> None:
    linked = workshop.link(BASE, model(row.format("")))
    assert "<replicate" in linked.xml
    linked.check()


def test_what_is_multiplied_with_it_keeps_it_as_it_is(workshop: Workshop) -> None:
    sensor = '<sensor><framepos objtype="site" objname="s"/></sensor>'
    fault = workshop.link(CLOCK, model(ROWS["one axis"].format(""), more=sensor)).fault
    assert "would multiply" in fault.message
