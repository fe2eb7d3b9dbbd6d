from __future__ import annotations

import pytest
from mjcompose.compose.key_names import entries_by_name, is_glob_of
from mjcompose.tree.pattern import BadPattern

NAMES = ["FL_hip", "FR_hip", "arm/FL_hip", "a*"]


def test_a_name_wins_over_globs_and_all_globs_that_fit_are_returned() -> None:
    written = ["*_hip", "FL_*", "FL_hip", "none"]
    assert entries_by_name(written, NAMES, "/") == {"FL_hip": ["FL_hip"], "FR_hip": ["*_hip"]}
    assert entries_by_name(["*_hip", "F*"], ["FL_hip"], "/") == {"FL_hip": ["*_hip", "F*"]}


def test_a_glob_stops_at_the_separator() -> None:
    assert list(entries_by_name(["*_hip"], NAMES, ":")) == ["FL_hip", "FR_hip", "arm/FL_hip"]
    assert list(entries_by_name(["**_hip"], NAMES, "/")) == ["FL_hip", "FR_hip", "arm/FL_hip"]


def test_a_name_that_looks_like_a_glob_is_a_name() -> None:
    assert entries_by_name(["a*"], NAMES, "/") == {"a*": ["a*"]}
    assert not is_glob_of("a*", NAMES) and is_glob_of("b*", NAMES) and not is_glob_of("b", NAMES)


def test_a_regular_expression_that_is_wrong() -> None:
    with pytest.raises(BadPattern):
        entries_by_name(["/(/"], NAMES, "/")
