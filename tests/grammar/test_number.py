"""Numbers as text, with MuJoCo as the judge."""

from __future__ import annotations

import math

import mujoco
import pytest
from hypothesis import given
from hypothesis import strategies as st

from composer.grammar.number import items, parse_int, parse_real

TEXTS = (
    "1 +1 -1 1. .5 . 1e5 1E5 1e+5 1e 0x10 0X1P3 0x1.8p1 0x 1_0 infinity INF -inf inf2 nan NaN nan(1) nan( 1f"
    " 1d0 1,2 1e400 -1e400 --1 +-1 １ 1;2 010 1.0 99999999999 2147483647 2147483648 -2147483648"
    " -2147483649 1a e5 +"
).split()


def read(attribute: str, text: str) -> float | None:
    """What MuJoCo makes of an attribute of a geom."""
    xml = f'<mujoco><worldbody><geom {attribute}="{text}"/></worldbody></mujoco>'
    try:
        geom = mujoco.MjSpec.from_string(xml).geoms[0]
    except ValueError:
        return None
    value: float = getattr(geom, attribute)
    return value


@pytest.mark.parametrize("text", TEXTS)
def test_real(text: str) -> None:
    theirs, ours = read("mass", text), parse_real(text)
    assert (theirs is None) == (ours is None)
    assert theirs == ours or (math.isnan(theirs or 0) and math.isnan(ours or 0))


@pytest.mark.parametrize("text", TEXTS)
def test_int(text: str) -> None:
    assert read("group", text) == parse_int(text)


@given(st.floats())
def test_every_float_is_re_read(value: float) -> None:
    again = parse_real(repr(value))
    assert again == value or (math.isnan(value) and again is not None and math.isnan(again))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", []),
        ("  ", []),
        ("1 2", ["1", "2"]),
        ("\t1\n2 \r", ["1", "2"]),
        ("1\xa02", ["1\xa02"]),
        ("1,2", ["1,2"]),
    ],
)
def test_items(text: str, expected: list[str]) -> None:
    assert items(text) == expected
