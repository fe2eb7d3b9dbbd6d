from __future__ import annotations

import re
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from composer.tree.glob import is_glob, matcher


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
    assert [name for name in ("a", "left_a", "b", "left_") if matcher("{left_,}{a,b*}")(name)] == [
        "a",
        "left_a",
        "b",
    ]


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
