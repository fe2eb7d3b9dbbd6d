from __future__ import annotations

import pytest

from composer.document.piece import Path, is_appended, is_edits, is_of_elements


@pytest.mark.parametrize(
    "path", [("edit",), ("base", "edit"), ("attach", "arm", "edit"), ("attach", "edit", "edit")]
)
def test_lists_of_edits(path: Path) -> None:
    assert is_edits(path) and is_appended(path) and not is_of_elements(path)
    assert is_of_elements((*path, 0, "set", "mass")) and not is_edits((*path, 0))


@pytest.mark.parametrize(
    "path",
    [
        (), ("base",), ("attach", "edit"), ("sensor", "edit"), ("sensor", "edit", "edit"), ("option", "edit"),
        ("base", "with", "edit"), ("attach", "arm", "with", "edit"), ("asset", "mesh", "edit"),
    ],
)  # fmt: skip
def test_what_is_only_called_so(path: Path) -> None:
    assert not is_edits(path) and not is_appended(path) and not is_of_elements(path)


@pytest.mark.parametrize(
    ("path", "is_where"),
    [
        (("base", "drop", 0, "where", "mass"), True),
        (("attach", "arm", "drop", 0, "parent", "where"), True),
        (("check", "have", "exists", 0, "where"), True),
        (("randomize", "fields", "mass", "select", "where"), True),
        (("check", "where", "mass", "range"), False),
        (("sensor", "where", "noise"), False),
        (("attach", "where", "pos"), False),
        (("attach", "arm", "with", "where"), False),
        (("randomize", "fields", "where", "uniform"), False),
    ],
)
def test_what_a_selector_compares(path: Path, is_where: bool) -> None:
    assert is_of_elements(path) is is_where
