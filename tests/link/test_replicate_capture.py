from __future__ import annotations

import pytest
from link.workshop import Piece, Workshop

REPLICATE = '<mujoco><worldbody><replicate count="2" offset="1 0 0"><body name="r"><geom size=".1"/></body></replicate></worldbody></mujoco>'
REFERRED_TO = REPLICATE.replace(
    "</mujoco>", '<sensor><framepos objtype="body" objname="r"/></sensor></mujoco>'
)
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
