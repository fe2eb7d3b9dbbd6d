from __future__ import annotations

import re

import pytest
from link.workshop import BASE, Piece, Workshop

MODEL = """<mujoco>{}
  <worldbody><body name="b"><joint name="j"/><geom size=".1"/></body></worldbody>
  <actuator><position name="a" joint="j"{}/></actuator>
</mujoco>"""
EARLIER = '<default><position kp="4"/><default class="x"><velocity kv="7"/></default></default>'

# Each may find its gain in another class once the top class is wrapped, section by section.
MOVED = {
    "class of another kind": (EARLIER + '<default><velocity kv="9"/></default>', ' class="x"'),
    "class of no kind": (
        '<default><default class="x"/></default><default><position kp="9"/></default>',
        ' class="x"',
    ),
    "class in which another kind stands before": (
        '<default><velocity kv="9"/></default><default><position kp="4"/><default class="x"><velocity/><position/></default></default>',
        ' class="x"',
    ),
    "top class of another kind": (EARLIER + '<default><velocity kv="9"/></default>', ""),
}
KEPT = {
    "class of its own kind": (
        '<default><default class="x"><position kp="5"/></default></default><default><velocity kv="9"/></default>',
        ' class="x"',
    ),
    "no actuators later": (EARLIER + '<default><geom rgba="1 0 0 1"/></default>', ' class="x"'),
    "class of the only section that sets actuators": (
        '<default><geom rgba="1 0 0 1"/></default>' + EARLIER,
        ' class="x"',
    ),
    "one section": (EARLIER, ' class="x"'),
}


LOST = EARLIER + '<default><general gainprm="9"/></default>'
"""The `<general>` gives the top class a gain that no `<position>` of a class says."""


@pytest.mark.parametrize(("defaults", "of"), MOVED.values(), ids=MOVED.keys())
def test_an_actuator_that_would_find_another_gain_says_its_own(
    workshop: Workshop, defaults: str, of: str
) -> None:
    model = MODEL.format(defaults, of)
    workshop.link(BASE, model).check()
    workshop.link(model, Piece(model, "again/")).check()


def test_nothing_is_written_where_the_gain_is_the_same(workshop: Workshop) -> None:
    defaults = '<default><default class="x"/></default><default><position timeconst=".1"/></default>'
    model = MODEL.format(defaults, ' class="x"')
    linked = workshop.link(BASE, model)
    assert '<position name="part/a" joint="part/j" class="part/x"/>' in linked.xml
    linked.check()


@pytest.mark.mujoco4("a `<position>` keeps the gain of its class")
def test_a_gain_that_cannot_be_written_is_refused(workshop: Workshop) -> None:
    model = MODEL.format(LOST, ' class="x"')
    for fault in (workshop.link(BASE, model).fault, workshop.link(model, BASE).fault):
        assert fault.code == "not-supported"
        assert "the `<position>` `a` would take another gain" in fault.message
        assert (
            fault.span is not None
            and fault.span.line == model[: model.index("<position name")].count("\n") + 1
        )


@pytest.mark.parametrize(("defaults", "of"), KEPT.values(), ids=KEPT.keys())
def test_others_compose(workshop: Workshop, defaults: str, of: str) -> None:
    model = MODEL.format(defaults, of)
    workshop.link(BASE, model).check()
    workshop.link(model, Piece(model, "again/")).check()


@pytest.mark.parametrize(("defaults", "of"), MOVED.values(), ids=MOVED.keys())
def test_joined_sections_compose(workshop: Workshop, defaults: str, of: str) -> None:
    joined = re.sub("</default><default>(?=<position|<velocity|<general)", "", defaults)
    assert joined != defaults
    workshop.link(BASE, MODEL.format(joined, of)).check()
