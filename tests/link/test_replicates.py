from __future__ import annotations

import pytest
from link.workshop import BASE, OLDER, Piece, Workshop, placed

REPLICATE = '<mujoco><worldbody><replicate count="2" offset="1 0 0"><body name="r"><geom size=".1"/></body></replicate></worldbody></mujoco>'
REFERRED_TO = REPLICATE.replace("</mujoco>", '<sensor><framepos objtype="body" objname="r"/></sensor></mujoco>')
WORLD = '<worldbody><body name="b"><joint name="j1"/><joint name="j10" axis="1 0 0"/><joint name="k" axis="0 1 0"/><geom name="g" size=".1"/></body></worldbody>'


def part(sections: str) -> str:
    return f'<mujoco><asset><material name="m"/></asset>{WORLD}{sections}</mujoco>'


MULTIPLIED = {
    "clock": '<sensor><clock name="t"/></sensor>',
    "user": '<sensor><user name="u" dim="1"/></sensor>',
    "tuple of assets": '<custom><tuple name="t"><element objtype="material" objname="m"/></tuple></custom>',
    "tendons": '<tendon><fixed name="t1"><joint joint="k" coef="1"/></fixed><fixed name="t10"><joint joint="k" coef="1"/></fixed></tendon><actuator><motor name="m" tendon="t1"/></actuator>',
}
J1 = '<actuator><motor name="m" joint="j1"/></actuator>'
KEPT = {
    "joint": '<actuator><motor name="m" joint="k"/></actuator><sensor><jointpos name="p" joint="j10"/></sensor>',
    "world": '<sensor><framepos name="p" objtype="body" objname="world"/></sensor>',
    "number": '<custom><numeric name="n" data="1"/><text name="t" data="x"/></custom>',
    "tuple": '<custom><tuple name="t"><element objtype="joint" objname="k"/></tuple></custom>',
}


@pytest.mark.parametrize("sections", MULTIPLIED.values(), ids=MULTIPLIED.keys())
@pytest.mark.parametrize("swapped", [False, True])
def test_what_a_replicate_would_multiply_in_another_unit_is_refused(
    workshop: Workshop, sections: str, swapped: bool
) -> None:
    first, second = (part(sections), REFERRED_TO) if swapped else (REFERRED_TO, part(sections))
    fault = workshop.link(first, Piece(second, "p/")).fault
    assert fault.code == "not-supported"
    assert "would multiply" in fault.message


@pytest.mark.parametrize("sections", KEPT.values(), ids=KEPT.keys())
def test_what_it_does_not_multiply_composes(workshop: Workshop, sections: str) -> None:
    workshop.link(REPLICATE, Piece(part(sections), "p/")).check()


@pytest.mark.parametrize("sections", KEPT.values(), ids=KEPT.keys())
def test_what_it_does_not_multiply_composes_into_a_base(workshop: Workshop, sections: str) -> None:
    workshop.link(part(sections), Piece(REPLICATE, "p/")).check()


def test_names_count_that_stand_before_the_replicate(workshop: Workshop) -> None:
    assert workshop.link(part(J1), Piece(REFERRED_TO, "p/")).fault.code == "not-supported"
    workshop.link(REFERRED_TO, Piece(part(J1), "p/")).check()


@pytest.mark.parametrize("row", [REPLICATE, REFERRED_TO])
def test_names_count_that_another_replicate_makes(workshop: Workshop, row: str) -> None:
    base = """<mujoco><worldbody><geom name="g" size=".1"/><geom name="h" size=".1"/>
        <replicate count="3" offset="0 1 0"><geom name="h0" size=".1"/></replicate></worldbody>
      <contact><pair name="q" geom1="h" geom2="g"/></contact></mujoco>"""
    linked = workshop.link(base, Piece(row.replace('count="2"', 'count="11"'), "p/"))
    if row == REFERRED_TO:
        assert "would multiply the `<pair>` `q`" in linked.fault.message
    else:
        linked.check(tolerance=1e-12)


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
def test_copies_are_what_mujoco_makes_of_them(workshop: Workshop, row: str, childclass: str, settings: str) -> None:
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
