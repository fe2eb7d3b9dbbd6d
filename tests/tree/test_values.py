"""Checks of values: the messages, and MuJoCo as the judge of what is wrong.

Numbers as text, with MuJoCo as the judge.
"""

from __future__ import annotations

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from mjcompose.tree.grammar import GRAMMAR, Attribute
from mjcompose.tree.values import check_python, check_value, items, parse_int, parse_real

SHAPES = "`plane`, `hfield`, `sphere`, `capsule`, `ellipsoid`, `cylinder`, `box`, `mesh` or `sdf`"
MEASURED = "`found`, `force`, `torque`, `dist`, `pos`, `normal`, `tangent`, `linvel` or `angvel`"
TEXTS = ["", " ", "1", " 1 ", "1 2", "1 2 3", "1 0 0 1", "1 2 3 4 5", "1.5", "1,2", "box", "box ", "true", "x"]


def attribute(path: str) -> Attribute:
    element, _, name = path.rpartition("/")
    return GRAMMAR.element(element).attributes[name]


@pytest.mark.parametrize(
    ("path", "text", "message"),
    [
        ("geom/pos", "1 2 3", None),
        ("geom/pos", " 1\n2\t3 ", None),
        ("geom/pos", "", None),
        ("geom/pos", "1 2", "expects 3 numbers, got 2"),
        ("geom/pos", "1 2 3 4", "expects 3 numbers, got 4"),
        ("geom/pos", "1,2,3", "expects numbers separated by spaces, got `1,2,3`"),
        ("geom/pos", "1 2 x", "expects 3 numbers, got `x`"),
        ("geom/size", "1 2 3 4", "expects 1 to 3 numbers, got 4"),
        ("geom/mass", "1 2", "expects a number, got 2"),
        ("geom/mass", "heavy", "expects a number, got `heavy`"),
        ("geom/group", "1.0", "expects an integer, got `1.0`; write 1"),
        ("geom/group", "1.5", "expects an integer, got `1.5`"),
        ("geom/group", "nan", "expects an integer, got `nan`"),
        ("geom/group", "2147483648", "expects an integer of 32 bits, got `2147483648`"),
        ("geom/shellinertia", "true", None),
        ("geom/shellinertia", "True", "expects `true` or `false`, got `True`"),
        ("geom/type", "box", None),
        ("geom/type", "Box", "has no keyword `Box`; it is spelled `box`"),
        ("geom/type", "", f"expects {SHAPES}, got nothing"),
        ("mesh/builtin", "", "expects a keyword, got nothing"),
        ("option/cone", "round", "expects `pyramidal` or `elliptic`, got `round`"),
        ("mesh/builtin", "gear", "has no keyword `gear`"),
        ("camera/output", "depth rgb", None),
        ("camera/output", "rgb rgb", "has `rgb` twice"),
        ("sensor/contact/data", "found force", None),
        ("sensor/contact/data", "force found", "expects its keywords in the order [found, force]"),
        ("sensor/contact/data", "found, force", f"expects {MEASURED}, got `found,`"),
        ("compiler/eulerseq", "xyz", None),
        ("compiler/eulerseq", "xy", "expects 3 characters, got 2"),
        ("texture/gridlayout", "x" * 13, "expects 1 to 12 characters, got 13"),
        ("frame/scale", "1 2", "expects 1 or 3 numbers, got 2"),
        ("frame/scale", "2", None),
        ("keyframe/key/qpos", "0 0.5 nan inf 0x1p3", None),
        ("keyframe/key/qpos", "0 1e400", "expects numbers, got `1e400`"),
        ("flex/body", "a b c", None),
        ("geom/material", "any text, really", None),
    ],
)
def test_text(path: str, text: str, message: str | None) -> None:
    answer = check_value(attribute(path), text)
    assert (None if answer is None else str(answer)) == message


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("geom/pos", [0, 0.5, 1], None),
        ("geom/pos", (0, 0.5, 1), None),
        ("geom/pos", np.zeros(3), None),
        ("geom/mass", np.float64(1), None),
        ("geom/size", 0.1, None),
        ("geom/size", [], "expects 1 to 3 numbers, got 0"),
        ("geom/pos", [0, 0], "expects 3 numbers, got 2"),
        ("geom/pos", 0.5, "expects 3 numbers, got 1"),
        ("geom/pos", "0 0 0.1", "expects 3 numbers, got text; write [0, 0, 0.1]"),
        ("geom/pos", "0, 0, 0.1", "expects 3 numbers, got text; write [0, 0, 0.1]"),
        ("geom/pos", "above", "expects 3 numbers, got `above`"),
        ("geom/pos", [0, "0", 0], "expects every item to be a number, got `0`"),
        ("geom/pos", [0, True, 0], "expects every item to be a number, got `true`"),
        ("geom/pos", None, "expects 3 numbers, got nothing"),
        ("geom/pos", {"x": 0}, "expects every item to be a number, got `{'x': 0}`"),
        ("geom/mass", True, "expects a number, got `true`"),
        ("geom/mass", [1], "expects a number, got a list of 1"),
        ("geom/mass", "1", "expects a number, got `1`"),
        ("geom/mass", 10**400, "expects a number, got one that is too large"),
        ("geom/group", 2, None),
        ("geom/group", 2.0, None),
        ("geom/group", 2.5, "expects an integer, got `2.5`"),
        ("geom/group", 2**31, "expects an integer of 32 bits, got `2147483648`"),
        ("geom/group", float("inf"), "expects an integer, got `inf`"),
        ("geom/shellinertia", True, None),
        ("geom/shellinertia", "true", "expects `true` or `false`, got `true`"),
        ("geom/shellinertia", 1, "expects `true` or `false`, got `1`"),
        ("joint/limited", True, None),
        ("joint/limited", "auto", None),
        ("joint/limited", "yes", "expects `false`, `true` or `auto`, got `yes`"),
        ("joint/limited", 0.5, "expects a keyword, got a number"),
        ("visual/headlight/active", 1, None),
        ("visual/headlight/active", False, None),
        ("geom/type", ["box"], "expects a keyword, got a list"),
        ("sensor/contact/data", ["found", "force"], None),
        ("sensor/contact/data", "found", None),
        ("sensor/contact/data", "found force", "expects a list of keywords, got text; write [found, force]"),
        ("sensor/contact/data", ["force", "found"], "expects its keywords in the order [found, force]"),
        ("sensor/contact/data", [1.5], "expects every item to be a keyword"),
        ("sensor/contact/data", [], "expects a list of keywords, got an empty list"),
        ("sensor/contact/data", 3.5, "expects a list of keywords, got `3.5`"),
        ("flex/body", ["a", "b"], None),
        ("flex/body", "a b", "expects a list of names, got text; write [a, b]"),
        ("flex/body", ["a b"], "expects names without spaces, got `a b`"),
        ("flex/body", [], "expects a list of names, got an empty list"),
        ("geom/material", "steel", None),
        ("geom/material", 3, "expects a name, got a number `3`; quote it: '3'"),
        ("geom/name", True, "expects a name, got a boolean `true`; quote it: 'true'"),
        ("geom/name", ["a"], "expects a name, got a list"),
        ("geom/name", {"a": 1}, "expects a name, got a mapping"),
        ("contact/pair/geom1", "", "must not be empty"),
        ("compiler/eulerseq", "xy", "expects 3 characters, got 2"),
        ("compiler/meshdir", "assets", None),
        ("frame/scale", [1, 2], "expects 1 or 3 numbers, got 2"),
        ("frame/scale", 2, None),
    ],
)
def test_python(path: str, value: object, message: str | None) -> None:
    answer = check_python(attribute(path), value)
    assert (None if answer is None else str(answer)) == message


def test_what_is_wrong_is_in_fields() -> None:
    words = check_value(attribute("geom/type"), "spheer")
    assert words is not None and words.unknown == "spheer" and words.lists_keywords
    count = check_value(attribute("geom/pos"), "1 2")
    assert count is not None and count.is_length
    text = check_python(attribute("geom/pos"), "1, 2, 3")
    assert text is not None and not text.is_length and text.instead == "[1, 2, 3]"
    assert text.advice == "write [1, 2, 3]" and text.message == "expects 3 numbers, got text"


@pytest.mark.parametrize("name", ["mass", "group", "pos", "rgba", "type", "shellinertia", "friction"])
@pytest.mark.parametrize("text", TEXTS)
def test_text_as_mujoco_judges(name: str, text: str) -> None:
    if name == "group" and not text.strip() and mujoco.__version__.startswith("3.11."):
        pytest.skip("MuJoCo 3.11 refuses an empty group")
    xml = f'<mujoco><worldbody><geom {name}="{text}"/></worldbody></mujoco>'
    try:
        mujoco.MjSpec.from_string(xml)
    except ValueError:
        refused = True
    else:
        refused = False
    assert (check_value(attribute(f"geom/{name}"), text) is not None) == refused


def test_long_text_is_cut() -> None:
    answer = check_value(attribute("geom/mass"), "x" * 200)
    assert answer is not None
    assert len(str(answer)) < 80


NUMBER_TEXTS = (
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


@pytest.mark.parametrize("text", NUMBER_TEXTS)
def test_real(text: str) -> None:
    theirs = read("mass", text)
    ours = parse_real(text)
    assert (theirs is None) == (ours is None)
    assert theirs == ours or (math.isnan(theirs or 0) and math.isnan(ours or 0))


@pytest.mark.parametrize("text", NUMBER_TEXTS)
def test_int(text: str) -> None:
    assert read("group", text) == parse_int(text)


@given(st.floats())
def test_every_float_is_re_read(value: float) -> None:
    again = parse_real(repr(value))
    assert again == value or (math.isnan(value) and again is not None and math.isnan(again))


@pytest.mark.parametrize(
    ("text", "expected"),
    [("", []), ("  ", []), ("1 2", ["1", "2"]), ("\t1\n2 \r", ["1", "2"]), ("1\xa02", ["1\xa02"]), ("1,2", ["1,2"])],
)
def test_items(text: str, expected: list[str]) -> None:
    assert items(text) == expected
