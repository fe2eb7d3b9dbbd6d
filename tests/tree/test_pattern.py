from __future__ import annotations

import pytest

from composer.tree.pattern import BadPattern, fitter, fitting, is_pattern, is_quick

NAMES = ["pad1", "left/pad2", "x"]


@pytest.mark.parametrize(
    ("pattern", "meant"),
    [("*pad?", ["pad1"]), ("**pad?", NAMES[:2]), ("/.*pad[0-9]/", NAMES[:2]), ("x", ["x"])],
)
def test_a_name_is_meant_by_a_name_a_glob_or_an_expression(pattern: str, meant: list[str]) -> None:
    assert list(filter(fitter(pattern, lambda: NAMES, "/"), NAMES)) == meant
    assert is_pattern(pattern) == (pattern != "x")


def test_an_expression_that_is_not_valid_is_a_fault() -> None:
    with pytest.raises(BadPattern, match=r"`/\(/` is not valid: missing \)"):
        fitting("(", NAMES)


def test_an_expression_has_its_time() -> None:
    with pytest.raises(BadPattern, match="takes longer"):
        fitting("(a+)+b", ["a" * 40], seconds=0.5)


@pytest.mark.parametrize("pattern", ["*" * 10_001, f"/{'a' * 10_000}/"])
def test_a_pattern_that_nobody_writes_is_not_tried(pattern: str) -> None:
    with pytest.raises(BadPattern, match="is too long; 10000 are allowed"):
        fitter(pattern, list, "/")


@pytest.mark.parametrize(
    "pattern", ["(a|a)*", "(?:a?){9}b", "a+a+b", r"(a|b)\1", "(?=a)a", "a?" * 9, "(a|a)" * 9]
)
def test_an_expression_that_may_try_much_is_tried_aside(pattern: str) -> None:
    assert not is_quick(pattern)


@pytest.mark.parametrize("pattern", ["link[0-9]+", "(left|right)_(hip|knee).*", r"pad_\d?", "a.b"])
def test_an_expression_as_people_write_it_is_tried_here(pattern: str) -> None:
    assert is_quick(pattern)
