"""Who is answered."""

from __future__ import annotations

import pytest

from composer.view.guard import Guard

GUARD = Guard("127.0.0.1", 8080, "secret")
OWN = "127.0.0.1:8080"


@pytest.mark.parametrize(
    ("target", "hosts", "origins", "expected"),
    [
        ("/secret/", [OWN], [], ""),
        ("/secret/model/3", ["LOCALHOST:8080"], [], "model/3"),
        ("/secret/play", [OWN], [f"http://{OWN}"], "play"),
        ("/secret/../x?y", [OWN], [], "../x?y"),  # nothing is resolved: it is no key of the server's table
        ("/", [OWN], [], None),
        ("", [OWN], [], None),
        ("/secret", [OWN], [], None),
        ("secret/", [OWN], [], None),
        ("//secret/", [OWN], [], None),
        ("/secret?/", [OWN], [], None),
        ("/SECRET/", [OWN], [], None),
        ("/secre/", [OWN], [], None),
        ("/secrets/", [OWN], [], None),
        ("/wrong/", [OWN], [], None),
        ("/s\xe9cret/", [OWN], [], None),
        ("/s\ud800ret/", [OWN], [], None),
        ("/secret/", [], [], None),
        ("/secret/", [OWN, OWN], [], None),
        ("/secret/", ["evil.example:8080"], [], None),
        ("/secret/", ["127.0.0.1:9090"], [], None),
        ("/secret/", ["127.0.0.1"], [], None),
        ("/secret/", [OWN], ["http://evil.example"], None),
        ("/secret/", [OWN], ["http://localhost:8080"], None),
        ("/secret/", [OWN], [f"http://{OWN}.evil.example"], None),
        ("/secret/", [OWN], [f"http://{OWN}/"], None),
        ("/secret/", [OWN], ["http://127.0.0.1:808"], None),
        ("/secret/", [OWN], [f"https://{OWN}"], None),
        ("/secret/", [OWN], [f"http://{OWN}", f"http://{OWN}"], None),
        ("/secret/", [OWN], ["null"], None),
        ("/secret/", [OWN], [""], None),
    ],
)
def test_token_host_and_origin_must_be_right(
    target: str, hosts: list[str], origins: list[str], expected: str | None
) -> None:
    assert GUARD.key_of(target, hosts, origins) == expected


@pytest.mark.parametrize("host", ["0.0.0.0", "::", ""])
def test_who_listens_everywhere_is_asked_by_any_one_name(host: str) -> None:
    guard = Guard(host, 8080, "secret")
    assert guard.address == "http://127.0.0.1:8080/secret/"
    assert guard.key_of("/secret/", ["robot.lab:8080"], []) == ""
    assert guard.key_of("/secret/", ["robot.lab:8080"], ["http://robot.lab:8080"]) == ""
    assert guard.key_of("/secret/", ["robot.lab:8080"], ["http://evil.example"]) is None
    assert guard.key_of("/secret/", ["robot.lab:8080", "robot.lab:8080"], []) is None
    assert guard.key_of("/wrong/", ["robot.lab:8080"], []) is None


def test_addresses_of_version_6_have_brackets() -> None:
    assert Guard("::1", 80, "t").address == "http://[::1]:80/t/"
