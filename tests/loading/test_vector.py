from __future__ import annotations

import numpy as np
import pytest

from composer.loading.errors import UnknownNameError
from composer.loading.numbers import Lookup, Numbers
from composer.loading.vector import UNLIMITED, Entry, Vector

VECTOR = Vector(
    "qpos",
    "joint",
    [
        Entry("left/a", 0, ("rad",), ((-1, 1),), "l", "arm.xml:3"),
        Entry("left/a/b", 1, ("m",), ((0, 2),), "l"),
        Entry("", 2, ("quaternion",) * 4, (UNLIMITED,) * 4, "ball"),
        Entry("right/a", 6, ("rad",), (UNLIMITED,), "r"),
        Entry("odd*", 7, (), ()),
    ],
    "/",
)


def test_one_number_is_an_int_and_several_a_slice() -> None:
    assert VECTOR["left/a"] == 0
    assert VECTOR.on("ball") == slice(2, 6)
    assert VECTOR.on("l") == slice(0, 2)
    assert VECTOR.on("r") == 6
    assert VECTOR["odd*"] == slice(7, 7)  # what is there is no glob


def test_several_names_are_an_array_in_their_order() -> None:
    found = VECTOR["right/a", "left/a"]
    assert isinstance(found, np.ndarray) and found.dtype == np.intp
    assert found.tolist() == [6, 0]
    assert VECTOR.array("left/a").tolist() == [0]


@pytest.mark.parametrize(
    ("glob", "expected"),
    [("*/a", [0, 6]), ("left/**", [0, 1]), ("{right,left}/a", [0, 6]), ("**/b", [1]), ("/.*a/", [0, 6])],
)
def test_globs_have_the_order_of_the_model(glob: str, expected: list[int]) -> None:
    found = VECTOR[glob]
    assert isinstance(found, np.ndarray)
    assert found.tolist() == expected


def test_limits_and_units_are_told_for_each_number() -> None:
    assert VECTOR.limits(["left/a", "right/a"]).tolist() == [[-1, 1], [-np.inf, np.inf]]
    assert VECTOR.limits().shape == (VECTOR.size, 2) == (7, 2)
    assert VECTOR.units("left/*") == ("rad",)
    assert VECTOR.origin("left/a") == "arm.xml:3"


def test_it_is_a_collection_of_names() -> None:
    assert list(VECTOR) == ["left/a", "left/a/b", "right/a", "odd*"]
    assert "left/a" in VECTOR and "a" not in VECTOR
    assert len(VECTOR) == 5


@pytest.mark.parametrize("name", ["a", "lefta", "left/c*"])
def test_a_name_that_is_not_there_is_told_with_those_that_are(name: str) -> None:
    with pytest.raises(UnknownNameError) as caught:
        VECTOR[name]
    assert isinstance(caught.value, KeyError)
    assert f"the model has no joint `{name}`" in str(caught.value)
    assert "joints that exist:" in str(caught.value) and "right/a" in str(caught.value)


def test_a_regular_expression_that_is_not_valid_is_reported() -> None:
    with pytest.raises(UnknownNameError, match=r"`/\(/` is not valid: missing \)"):
        VECTOR["/(/"]


def test_what_was_meant_is_told() -> None:
    with pytest.raises(UnknownNameError, match="did you mean `left/a`"):
        VECTOR["left/A"]
    with pytest.raises(UnknownNameError, match="no body with a joint `bal`"):
        VECTOR.on("bal")


def test_numbers_of_elements() -> None:
    cameras = Numbers(Lookup("camera", ["", "left/eye", "right/eye"], "/"))
    assert cameras["right/eye"] == 2
    assert cameras["right/eye", "left/eye"].tolist() == [2, 1]
    assert np.asarray(cameras["*/eye"]).tolist() == [1, 2]
    assert len(cameras) == 3 and list(cameras) == ["left/eye", "right/eye"]
