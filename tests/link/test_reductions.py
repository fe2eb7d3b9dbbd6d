from __future__ import annotations

import pytest
from link.workshop import BASE, Workshop

BOTH = """
<mujoco><compiler fusestatic="true" discardvisual="true"/><worldbody>
  <body name="b"><joint/><geom size=".1"/><geom size=".2" contype="0" conaffinity="0"/>
    <body name="c" pos="1 0 0"><geom size=".3" contype="0" conaffinity="0"/></body></body>
</worldbody></mujoco>"""


def test_one_compilation_serves_both_settings(workshop: Workshop) -> None:
    composed = workshop.link(BASE, BOTH).check()
    assert (composed.nbody, composed.ngeom) == (2, 1)


def test_both_places_at_once(workshop: Workshop) -> None:
    workshop.link(BOTH, BOTH).check()


def test_a_model_alone_leaves_it_to_mujoco(workshop: Workshop) -> None:
    linked = workshop.link(BOTH, measure=None)
    assert 'fusestatic="true" discardvisual="true"' in linked.xml
    linked.check()


@pytest.mark.parametrize("setting", ["fusestatic", "discardvisual"])
def test_without_mujoco_at_hand_it_is_told(workshop: Workshop, setting: str) -> None:
    fault = workshop.link(BASE, f'<mujoco><compiler {setting}="true"/></mujoco>', measure=None).fault
    assert fault.code == "compiler-setting" and f"`{setting}`" in fault.message


def test_a_part_that_mujoco_rejects_is_told_by_its_own_names(workshop: Workshop) -> None:
    part = '<mujoco><compiler fusestatic="true"/><worldbody><body name="b"><geom name="g"/></body></worldbody></mujoco>'
    fault = workshop.link(BASE, part).fault
    assert fault.code == "mujoco-rejects" and "`g`" in fault.message
