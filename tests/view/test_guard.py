"""Who is answered."""

from __future__ import annotations

import pytest

from composer.view.guard import Guard

GUARD = Guard("127.0.0.1", 8080, "secret")
OWN = "127.0.0.1:8080"


@pytest.mark.parametrize(
    ("path", "headers", "expected"),
    [
        ("/secret/", {"host": OWN}, ""),
        ("/secret/model/3?x", {"host": "localhost:8080"}, "model/3"),
        ("/secret/play", {"host": OWN, "origin": f"http://{OWN}"}, "play"),
        ("/", {"host": OWN}, None),
        ("/secret", {"host": OWN}, None),
        ("/wrong/", {"host": OWN}, None),
        ("/sécret/", {"host": OWN}, None),
        ("/secret/", {}, None),
        ("/secret/", {"host": "evil.example:8080"}, None),
        ("/secret/", {"host": "127.0.0.1:9090"}, None),
        ("/secret/", {"host": OWN, "origin": "http://evil.example"}, None),
        ("/secret/", {"host": OWN, "origin": "http://localhost:8080"}, None),
        ("/secret/", {"host": OWN, "origin": "null"}, None),
    ],
)
def test_token_host_and_origin_must_be_right(
    path: str, headers: dict[str, str], expected: str | None
) -> None:
    assert GUARD.path_of(path, headers) == expected


def test_who_listens_everywhere_is_asked_by_any_name() -> None:
    guard = Guard("0.0.0.0", 8080, "secret")
    assert guard.address == "http://127.0.0.1:8080/secret/"
    assert guard.path_of("/secret/", {"host": "robot.lab:8080"}) == ""
    assert guard.path_of("/secret/", {"host": "robot.lab:8080", "origin": "http://evil.example"}) is None


def test_addresses_of_version_6_have_brackets() -> None:
    assert Guard("::1", 80, "t").address == "http://[::1]:80/t/"
