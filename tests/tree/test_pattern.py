from __future__ import annotations

import re
import time

import pytest
from hypothesis import given, strategies as st
from mjcompose.tree.pattern import BadPattern, fitter, fitting, is_glob, is_pattern, matcher


@pytest.mark.parametrize(
    ("glob", "separator", "name", "fits"),
    [
        ("*", "/", "pad", True),
        ("*", "/", "gripper/pad", False),
        ("**", "/", "gripper/pad", True),
        ("**/pad", "/", "pad", True),
        ("**/pad", "/", "left/gripper/pad", True),
        ("**/pad", "/", "left_pad", False),
        ("*/pad?", "/", "gripper/pad1", True),
        ("{left,right}/*", "/", "right/base", True),
        ("{left,right}/*", "/", "middle/base", False),
        ("left:*", ":", "left:a", True),
        ("left:*", ":", "left:a:b", False),
        ("left_*", "_", "left_arm_base", True),
        ("a.b*", "/", "axb", False),
        ("{a", "/", "{a", True),
    ],
)
def test_what_fits(glob: str, separator: str, name: str, fits: bool) -> None:
    assert matcher(glob, separator)(name) is fits


def test_what_is_a_glob() -> None:
    assert is_glob("a*") and is_glob("a?") and is_glob("{a,b}") and not is_glob("gripper/pad#[1]")


def test_choices_may_be_empty_and_hold_globs() -> None:
    assert [name for name in ("a", "left_a", "b", "left_") if matcher("{left_,}{a,b*}")(name)] == ["a", "left_a", "b"]


_PIECES = {
    "a": "a",
    "b": "b",
    "/": "/",
    "*": "[^/]*",
    "**": ".*",
    "**/": "(?:.*/)?",
    "?": "[^/]",
    "{a,b*,}": "(?:a|b[^/]*|)",
}


@given(st.lists(st.sampled_from(sorted(_PIECES)), max_size=6), st.text("ab/", max_size=8))
def test_the_same_as_the_regular_expression(pieces: list[str], name: str) -> None:
    glob = "".join(pieces).replace("***", "**")
    tokens = re.findall(r"\{[^}]*\}|\*\*/|\*\*|.", glob)
    expected = re.fullmatch("".join(_PIECES[token] for token in tokens), name) is not None
    assert matcher(glob)(name) is expected


@pytest.mark.parametrize("glob", ["**a" * 30 + "b", "*a" * 30 + "b", "{a,a}" * 40 + "b", "**/" * 30 + "b"])
@pytest.mark.parametrize("name", ["a" * 60, "a" * 50_000, "a/" * 50])
def test_no_glob_takes_long_for_any_name(glob: str, name: str) -> None:
    begun = time.process_time()
    assert matcher(glob)(name + "ba") is False
    assert time.process_time() - begun < 1


NAMES = ["pad1", "left/pad2", "x"]


@pytest.mark.parametrize(
    ("pattern", "meant"), [("*pad?", ["pad1"]), ("**pad?", NAMES[:2]), ("/.*pad[0-9]/", NAMES[:2]), ("x", ["x"])]
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
    ("pattern", "name"), [("a{e}", "a{e}"), ("a{e<=1}", "a{e<=1}"), (r"a\{e}", "a{e}"), ("a{2}", "aa"), ("[{]a", "{a")]
)
def test_braces_mean_what_they_mean_in_python(pattern: str, name: str) -> None:
    names = ["a", "ab", "b", "aa", "a{e}", "a{e<=1}", "{a"]
    assert fitting(pattern, names) == {each for each in names if re.fullmatch(pattern, each)} == {name}


@pytest.mark.parametrize("pattern", ["*" * 10_001, f"/{'a' * 10_000}/"])
def test_a_pattern_that_nobody_writes_is_not_tried(pattern: str) -> None:
    with pytest.raises(BadPattern, match="is too long; 10000 are allowed"):
        fitter(pattern, list, "/")
