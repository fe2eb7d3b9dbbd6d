from __future__ import annotations

import math

import pytest
from mjcompose.base.words import counted, element_text, number_text, numbers_text, plural, tag_text, value_text


@pytest.mark.parametrize(
    "number", [0.1 + 0.2, 1 / 3, 1e22, 5e-324, 1.7976931348623157e308, 123456789.125, -0.0, math.inf]
)
def test_a_number_reads_back_exactly(number: float) -> None:
    assert float(number_text(number)) == number
    assert math.copysign(1, float(number_text(number))) == math.copysign(1, number)


def test_numbers() -> None:
    assert numbers_text([1.0, -0.0, math.nan, math.inf, 10**30, 0.1]) == f"1 -0 nan inf {10**30} 0.1"
    assert number_text(10**400) == str(10**400)  # too large for a float


def test_values() -> None:
    assert value_text([True, (1.0, "a"), 0.5]) == "[true, [1, a], 0.5]"


# The kinds of MJCF and the nouns of messages.
PLURALS = {
    "actuator": "actuators",
    "body": "bodies",
    "default class": "default classes",
    "entry": "entries",
    "equality": "equalities",
    "flex": "flexes",
    "key": "keys",
    "mesh": "meshes",
    "mass": "masses",
    "keys": "keys",
    "try": "tries",
}


@pytest.mark.parametrize(("noun", "several"), PLURALS.items())
def test_plurals(noun: str, several: str) -> None:
    assert plural(noun) == several
    assert (counted(1, noun), counted(0, noun)) == (f"1 {noun}", f"0 {several}")


@pytest.mark.parametrize(
    ("kind", "without"),
    [("actuator", "an actuator"), ("equality", "an equality"), ("inertial", "an inertial"), ("key", "a key")],
)
def test_an_element_without_a_name_has_its_article(kind: str, without: str) -> None:
    assert element_text(kind, None) == f"{without} without a name"
    assert element_text(kind, "") == f"{without} without a name"
    assert element_text(kind, None, definite=True) == f"{without} without a name"
    assert element_text(kind, "a", definite=True) == f"the {kind} `a`"
    assert tag_text(kind, None) == f"`<{kind}>`"
