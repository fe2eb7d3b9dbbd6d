from __future__ import annotations

import re

import pytest

from composer.tree.pattern import BadPattern, fitter, fitting, is_pattern

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
        fitting("(a|a)*", ["a" * 5000 + "b"], seconds=0.1)


@pytest.mark.parametrize("pattern", ["(a+)+b", "(.|.)*!", "((a*)*)*b", "(?:a?){30}b", r"(a|b|ab)*\1c"])
def test_an_expression_that_once_had_no_end(pattern: str) -> None:
    assert fitting(pattern, ["a" * 60, "b" * 200]) == frozenset()


@pytest.mark.parametrize(
    ("pattern", "name"),
    [("a{e}", "a{e}"), ("a{e<=1}", "a{e<=1}"), (r"a\{e}", "a{e}"), ("a{2}", "aa"), ("[{]a", "{a")],
)
def test_braces_mean_what_they_mean_in_python(pattern: str, name: str) -> None:
    names = ["a", "ab", "b", "aa", "a{e}", "a{e<=1}", "{a"]
    assert fitting(pattern, names) == {each for each in names if re.fullmatch(pattern, each)} == {name}


@pytest.mark.parametrize("pattern", ["*" * 10_001, f"/{'a' * 10_000}/"])
def test_a_pattern_that_nobody_writes_is_not_tried(pattern: str) -> None:
    with pytest.raises(BadPattern, match="is too long; 10000 are allowed"):
        fitter(pattern, list, "/")
