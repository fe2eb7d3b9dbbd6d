"""Elements that a recipe adds come into the model as data, before the parts that wait for their places."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree
from mjcompose.base.diagnostic import Span
from mjcompose.base.sink import Sink
from mjcompose.link.additions import later_names, outermost_target, waiting
from mjcompose.link.link import link
from mjcompose.link.linking import AddedElement, AttachmentPlace, LaterPlace, Linking, Part, PlaceName
from mjcompose.tree.unit import Unit

HERE = Span("recipe.yaml", 1, 1)


def unit(text: str, name: str) -> Unit:
    return Unit(etree.fromstring(text), name, Path(), label=name)


def added(text: str, to: PlaceName, *places: PlaceName) -> AddedElement:
    return AddedElement(etree.fromstring(text), to, places, step=text)


def linking_with(*additions: AddedElement, place: AttachmentPlace | None = None) -> Linking:
    """An arm in the world, and a hand that waits for a place."""
    base = unit('<mujoco><worldbody><body name="table"/></worldbody></mujoco>', "base.xml")
    arm = unit('<mujoco><worldbody><body name="wrist"><geom size="1"/></body></worldbody></mujoco>', "arm.xml")
    hand = unit('<mujoco><worldbody><body name="palm"><geom size="1"/></body></worldbody></mujoco>', "hand.xml")
    parts = [Part(arm, "arm/"), Part(hand, "hand/", place or AttachmentPlace("body", "flange", span=HERE))]
    linking = Linking(base, parts[::-1], Sink())
    linking.additions = additions
    linking.later_places = {place: LaterPlace(each.to, HERE) for each in additions for place in each.places}
    return linking


PLATE = '<body name="plate"/>'
FLANGE = '<body name="holder"><frame name="grip"/><body name="flange"/></body>'


def test_a_part_hangs_on_an_element_that_hangs_on_an_element_of_a_part() -> None:
    plate = added(PLATE, ("body", "arm/wrist"), ("body", "plate"))
    flange = added(FLANGE, ("body", "plate"), ("body", "holder"), ("frame", "grip"), ("body", "flange"))
    linking = linking_with(plate, flange)
    seen: list[object] = []
    linking.watch = lambda units, done: seen.append(done)
    assert link(linking)
    palm = linking.base.root.find(".//body[@name='hand/palm']")
    assert palm is not None
    above = [str(node.get("name")) for node in palm.iterancestors("body")]
    assert above == ["flange", "holder", "plate", "arm/wrist"]
    assert [done for done in seen if isinstance(done, str)] == [PLATE, FLANGE]


def test_an_element_that_no_part_needs_stays_out() -> None:
    other = added('<body name="other"/>', ("world", ""), ("body", "other"))
    flange = added(FLANGE, ("world", ""), ("body", "flange"))
    linking = linking_with(other, flange)
    assert link(linking)
    assert (other.is_hung, flange.is_hung) == (False, True)
    assert later_names(linking) == [("body", "other")]


@pytest.mark.parametrize(
    ("to", "codes"),
    [
        (("body", "none"), []),  # the step that adds to nothing is reported when it is carried out
        (("body", "hand/palm"), ["attach-cycle"]),
    ],
)
def test_a_place_that_never_exists_stays_out(to: PlaceName, codes: list[str]) -> None:
    flange = added(FLANGE, to, ("body", "flange"))
    linking = linking_with(flange)
    link(linking)
    assert not flange.is_hung
    assert [each.code for each in linking.sink.errors] == codes


def test_what_a_place_needs_comes_from_the_outermost_to_the_innermost() -> None:
    one = added('<body name="one"/>', ("world", ""), ("body", "one"))
    two = added('<body name="two"/>', ("body", "one"), ("body", "two"))
    three = added('<body name="three"/>', ("body", "two"), ("body", "three"))
    linking = linking_with(one, two, three)
    assert waiting(linking, ("body", "three")) == [one, two, three]
    assert waiting(linking, ("body", "two")) == [one, two]
    assert waiting(linking, ("body", "table")) == []
    assert outermost_target(linking, ("body", "three")) == ("world", "")
    assert outermost_target(linking, ("body", "table")) is None
    linking.base.section("worldbody").append(one.node)
    assert waiting(linking, ("body", "three")) == [two, three]
