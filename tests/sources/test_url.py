from __future__ import annotations

import pytest

from composer.sources.url import take_apart


@pytest.mark.parametrize(
    "url",
    [
        "https://[::1/a.zip",
        "https://℀.com/a.zip",
        "https://host:port/a",
        "https://host:0/a",
        "https:///a",
        "",
    ],
)
def test_what_is_no_address(url: str) -> None:
    assert take_apart(url) is None


def test_relative_ones() -> None:
    found = take_apart("../b.zip", "https://host:8080/x/y/a.zip")
    assert found is not None and found.geturl() == "https://host:8080/x/b.zip"
    assert take_apart("//[::1/b", "https://host/a") is None
