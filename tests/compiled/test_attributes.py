"""The tables say the same of which array an attribute of MJCF becomes."""

from __future__ import annotations

import mujoco
import pytest

from composer.compiled.affected_arrays import arrays_of
from composer.compiled.attributes import ENUMERATED, TAGS, array_of, attributes
from composer.compiled.enums import ENUMS
from composer.compiled.quantities import _QUANTITIES

EVERY = [(tag, attribute) for tag in TAGS for attribute in attributes(tag)]


@pytest.mark.parametrize("tag", TAGS)
def test_the_array_of_an_attribute_is_among_those_that_follow_from_it(tag: str) -> None:
    missing = [each for each in attributes(tag) if array_of(tag, each) not in arrays_of(each, tag)]
    assert missing == []


def test_without_a_tag_it_is_the_end_of_its_name() -> None:
    assert {"solref", "solref_lim"} <= arrays_of("solreflimit") and "tendon_solref_lim" not in arrays_of(
        "solreflimit"
    )
    assert "qpos0" in arrays_of("ref")


def test_the_quantity_of_an_array_names_the_attribute() -> None:
    for tag, attribute in EVERY:
        known = _QUANTITIES.get(array_of(tag, attribute))
        assert known is None or attribute in known.attributes, (tag, attribute)


def test_words_are_of_arrays_with_enumerations() -> None:
    pairs = [(tag, attribute) for tag, names in ENUMERATED.items() for attribute in names]
    assert {array_of(*pair) for pair in pairs} == set(ENUMS) - {"actuator_trntype"}
    assert ENUMERATED["texture"] == {"type"} and not ENUMERATED["body"]


def test_the_arrays_are_mujocos() -> None:
    compiled = mujoco.MjModel.from_xml_string("<mujoco/>")
    assert {array_of(*pair) for pair in EVERY if not hasattr(compiled, array_of(*pair))} <= {
        "mat_metallic", "light_intensity", "geom_margin", "pair_margin"} | NEWER  # fmt: skip


NEWER = {array_of(tag, attribute) for tag, attribute in EVERY} if mujoco.__version__ < "4" else set()
