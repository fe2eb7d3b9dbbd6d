from __future__ import annotations

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
        fitting("(a+)+b", ["a" * 40], seconds=0.5)
