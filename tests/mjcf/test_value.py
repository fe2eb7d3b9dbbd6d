from __future__ import annotations

import numpy as np
import pytest

from composer.grammar import GRAMMAR
from composer.mjcf.value import BadValue, decode, encode

GEOM = GRAMMAR.element("geom").attributes
MESH = GRAMMAR.element("mesh").attributes


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("size", [1, 2.5], "1 2.5"),
        ("size", (0.1, np.float64(0.2)), "0.1 0.2"),
        ("size", np.array([0.1, 0.2, 0.3]), "0.1 0.2 0.3"),
        ("size", 0.1, "0.1"),
        ("size", "0.1  0x1p-1", "0.1  0x1p-1"),
        ("pos", np.array([1, 2, 3]), "1 2 3"),
        ("mass", 1, "1"),
        ("mass", np.array(2.0), "2"),
        ("group", 3.0, "3"),
        ("type", "mesh", "mesh"),
        ("name", "a b", "a b"),
    ],
)
def test_values_become_the_text_that_mjcf_has(name: str, value: object, text: str) -> None:
    assert encode(GEOM[name], value) == text


def test_bytes_are_no_list_of_numbers() -> None:
    for value in (b"abc", bytearray(3), np.bytes_(b"abc")):
        with pytest.raises(BadValue, match="expects 3 numbers"):
            encode(GEOM["pos"], value)


def test_text_is_taken_as_it_stands_in_xml() -> None:
    mocap, limited = (
        GRAMMAR.element("body").attributes["mocap"],
        GRAMMAR.element("joint").attributes["limited"],
    )
    assert [encode(mocap, value) for value in (True, "true", np.bool_(False))] == ["true", "true", "false"]
    assert [encode(limited, value) for value in (True, "auto")] == ["true", "auto"]
    for attribute, value in ((mocap, "yes"), (mocap, 1), (limited, "maybe"), (GEOM["type"], "sphere box")):
        with pytest.raises(BadValue):
            encode(attribute, value)


def test_rows_are_joined_where_any_number_of_items_will_do() -> None:
    assert encode(MESH["vertex"], np.eye(3)) == encode(MESH["vertex"], [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    assert encode(MESH["vertex"], np.eye(3)) == "1 0 0 0 1 0 0 0 1"


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("size", [1, 2, 3, 4], "1 to 3 numbers, got 4"),
        ("size", [], "got 0"),
        ("size", "1 x", "got `x`"),
        ("size", [True], "got `true`"),
        ("size", {1, 2}, "expects"),
        ("size", object(), "expects"),
        ("pos", np.zeros((3, 1)), "flat array, got one of shape (3, 1)"),
        ("pos", [0, 0, float("nan")], "got `nan`"),
        ("pos", "0 0 nan", "got `nan`"),
        ("pos", [0, 0, float("inf")], "expects finite numbers, got `inf`"),
        ("size", "-inf", "expects finite numbers, got `-inf`"),
        ("pos", np.array([1j, 0, 0]), "number"),
        ("pos", np.array(["a", "b", "c"]), "number"),
        ("mass", [1.0], "got a list of 1"),
        ("group", 1.5, "integer"),
        ("type", "spere", "got `spere`"),
        ("type", 3, "expects"),
        ("name", 3, "got a number `3`"),
        ("name", "a\x01", "XML cannot hold"),
    ],
)
def test_what_does_not_fit_is_told(name: str, value: object, told: str) -> None:
    with pytest.raises(BadValue) as caught:
        encode(GEOM[name], value)
    assert told in str(caught.value)


def test_numbers_come_back_as_numpy() -> None:
    size = decode(GEOM["size"], "0.1 0x1p3")
    assert isinstance(size, np.ndarray) and size.dtype == np.float64 and size.tolist() == [0.1, 8.0]
    mass, group = decode(GEOM["mass"], "2"), decode(GEOM["group"], "2")
    assert isinstance(mass, np.float64) and mass == 2.0
    assert isinstance(group, np.int64) and group == 2
    assert decode(GEOM["type"], "mesh") == "mesh"


@pytest.mark.parametrize(
    ("text", "numbers"),
    [("1 2.5 -.5e-3", [1, 2.5, -0.0005]), ("\t1\n2 3 ", [1, 2, 3]), ("+1. 0x10 1e300", [1, 16, 1e300])],
)
def test_numbers_are_read_however_they_are_written(text: str, numbers: list[float]) -> None:
    assert decode(GEOM["pos"], text).tolist() == numbers  # type: ignore[attr-defined]


@pytest.mark.parametrize("text", ["1 2 1_0", "1 2 3\u00a0", "1 2 1e999", "1 2 \u0663", "1,2,3", "1 2 3 4"])
def test_what_python_takes_for_numbers_and_mujoco_does_not_is_refused(text: str) -> None:
    with pytest.raises(BadValue):
        decode(GEOM["pos"], text)


@pytest.mark.parametrize("value", [0.1 + 0.2, 1e-300, -0.0, 1 / 3, 123456789.125])
def test_numbers_survive_to_the_bit(value: float) -> None:
    read = decode(GEOM["pos"], encode(GEOM["pos"], [value, 0, 0]))
    assert read[0].hex() == value.hex()  # type: ignore[index]


def test_text_that_mujoco_would_refuse_is_not_read() -> None:
    with pytest.raises(BadValue):
        decode(GEOM["pos"], "1 2")


def test_rows_are_of_one_length_and_any_precision() -> None:
    with pytest.raises(BadValue, match="expects rows of one length"):
        encode(MESH["vertex"], [[0, 0, 0], [1, 0]])
    assert encode(MESH["vertex"], np.full((2, 3), 0.5, np.longdouble)) == "0.5 0.5 0.5 0.5 0.5 0.5"


def test_axes_of_angles_are_letters() -> None:
    eulerseq = GRAMMAR.element("compiler").attributes["eulerseq"]
    assert encode(eulerseq, "XYz") == "XYz"
    for value, said in (
        ("xyw", "expects letters of `xyzXYZ`, got `w`"),
        ("xy", "expects 3 characters, got 2"),
    ):
        with pytest.raises(BadValue, match=said):
            encode(eulerseq, value)
