from __future__ import annotations

import pytest

from composer.grammar.version import exists_in, version_key


@pytest.mark.parametrize(
    ("version", "since", "until", "expected"),
    [
        ("3.12.0", None, None, True),
        ("3.9.1", "3.12.0", None, False),
        ("3.12.0", "3.12.0", "3.12.0", True),
        ("3.17.1", None, "3.17.0", False),
        ("4.0.0", "3.16.0", "3.17.0", False),
        ("10.0.0", "9.0.0", None, True),
    ],
)
def test_exists_in(version: str, since: str | None, until: str | None, expected: bool) -> None:
    assert exists_in(version, since, until) is expected


def test_suffix_is_left_out() -> None:
    assert version_key("4.0.0rc1") == (4, 0, 0)
    assert version_key("4.1.dev3") == (4, 1)
