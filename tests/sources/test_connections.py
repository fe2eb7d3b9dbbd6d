"""A connection is judged by the machine at its other end, before a byte is sent."""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Iterator
from ipaddress import ip_address
from pathlib import Path
from typing import Any

import pytest
from mjcompose.sources import address, connections
from mjcompose.sources.address import is_public
from mjcompose.sources.download import Version, download
from mjcompose.sources.fetching import Fetching, Lookup
from mjcompose.sources.reference import SourceError

PUBLIC = "93.184.216.34"


class Listener:
    """A server that notes what it gets, and answers nothing."""

    def __init__(self) -> None:
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = self.server.getsockname()[1]
        self.received: list[bytes] = []
        self.thread = threading.Thread(target=self._serve, daemon=True)
        self.thread.start()

    def _serve(self) -> None:
        try:
            while True:
                connection, _ = self.server.accept()
                connection.settimeout(2)
                with connection:
                    self.received.append(connection.recv(1000))
        except OSError:
            return

    def end(self) -> list[bytes]:
        self.thread.join(0.5)
        self.server.close()
        return self.received


@pytest.fixture
def listener() -> Iterator[Listener]:
    made = Listener()
    yield made
    made.server.close()


def confined(**environment: str) -> Lookup:
    own = {"MJCOMPOSE_TIMEOUT": "2", **environment}
    return Lookup(Path(), own, Fetching(), is_confined=True)


@pytest.fixture
def changing(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """DNS that has a public address for a name at first, and this machine's from then on; the names that it saw."""
    address._addresses.cache_clear()
    asked: list[str] = []

    def lookup(host: str, port: Any, *_: object, **__: object) -> Any:
        asked.append(host)
        found = PUBLIC if len(asked) == 1 else "127.0.0.1"
        return [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (found, port or 0))]

    monkeypatch.setattr(socket, "getaddrinfo", lookup)
    return asked


@pytest.mark.parametrize("scheme", ["http", "https"])
def test_a_name_that_changes_before_the_connection(
    listener: Listener, changing: list[str], tmp_path: Path, scheme: str
) -> None:
    url = f"{scheme}://robots.example.org:{listener.port}/a.zip"
    with pytest.raises(SourceError) as caught:
        download(url, tmp_path / "file.part", Version(), lookup=confined())
    assert caught.value.code == "source-outside"
    assert changing == ["robots.example.org", "robots.example.org"]
    assert b"".join(listener.end()) == b""


def test_a_version_of_urllib3_that_connects_in_another_way_connects_to_nothing(
    listener: Listener, changing: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections._PublicConnection, "_new_conn", connections.HTTPConnection._new_conn)
    with pytest.raises(SourceError) as caught:
        download(
            f"http://robots.example.org:{listener.port}/a.zip", tmp_path / "file.part", Version(), lookup=confined()
        )
    assert caught.value.code == "source-outside"
    assert b"".join(listener.end()) == b""


def test_a_public_server_gets_the_request(
    listener: Listener, changing: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(connections, "check_peer", lambda connection: None)
    with pytest.raises(SourceError) as caught:
        download(
            f"http://robots.example.org:{listener.port}/a.zip", tmp_path / "file.part", Version(), lookup=confined()
        )
    assert caught.value.code == "source-fetch"
    assert b"".join(listener.end()).startswith(b"GET /a.zip HTTP/1.1\r\nHost: robots.example.org")


class Ends:
    """A connection with these addresses of its two ends."""

    def __init__(self, peer: str, own: str) -> None:
        self.ends = peer, own
        self.is_closed = False

    def getpeername(self) -> Any:
        return (self.ends[0], 443)

    def getsockname(self) -> Any:
        return (self.ends[1], 50000)

    def close(self) -> None:
        self.is_closed = True


@pytest.mark.parametrize(
    ("peer", "own", "expected"),
    [
        (PUBLIC, "192.168.0.2", True),
        ("2606:4700::1", "2a00:1450::7", True),
        (f"::ffff:{PUBLIC}", "::ffff:192.168.0.2", True),
        ("64:ff9b::808:808", "2a00:1450::7", True),
        ("10.0.0.7", "192.168.0.2", False),
        ("::ffff:10.0.0.7", "::ffff:192.168.0.2", False),
        ("64:ff9b::a00:7", "2a00:1450::7", False),
        ("fe80::1%eth0", "fe80::2%eth0", False),
        (PUBLIC, PUBLIC, False),  # a public address of this machine
        ("", "192.168.0.2", False),
        ("/run/socket", "", False),
    ],
)
def test_the_other_end_is_judged(peer: str, own: str, expected: bool) -> None:
    connection: Any = Ends(peer, own)
    if expected:
        connections.check_peer(connection)
    else:
        with pytest.raises(connections.NotPublicError):
            connections.check_peer(connection)
    assert connection.is_closed != expected


@pytest.mark.parametrize("found", [[], [PUBLIC]])
def test_a_proxy_gets_no_name_that_cannot_be_judged_here(
    listener: Listener, tmp_path: Path, found: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(address, "_addresses", lambda name: tuple(map(ip_address, found)))
    proxy = {"https_proxy": f"http://127.0.0.1:{listener.port}"}
    with pytest.raises(SourceError) as caught:
        download("https://robots.example.org/a.zip", tmp_path / "file.part", Version(), lookup=confined(**proxy))
    assert caught.value.code == "source-fetch"
    received = b"".join(listener.end())
    assert received.startswith(b"CONNECT robots.example.org:443") == bool(found)
    assert ("resolved on this machine" in caught.value.message) != bool(found)


@pytest.mark.parametrize(
    "place",
    [
        r"https://10.0.0.7\@robots.example.org/b",
        "https://me@robots.example.org/b",
        "https://10.0.0.7/b",
        "https://0x7f.1/b",
        "https://[64:ff9b::7f00:1]/b",
        "//169.254.169.254/b",
        "https://robots.example.org/\tb",
    ],
)
def test_a_redirect_is_read_and_judged_as_the_first_address(
    web: Any, answer: Callable[..., None], tmp_path: Path, place: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only the first server is let through here; nothing else may be asked."""
    here = ip_address("127.0.0.1")
    monkeypatch.setattr(address, "is_this_machine", lambda netloc: False)
    monkeypatch.setattr(address, "is_public", lambda found: found == here or is_public(found))
    monkeypatch.setattr(connections, "check_peer", lambda connection: None)
    web.pages["/a"] = lambda handler: answer(handler, b"", status=302, Location=place)
    with pytest.raises(SourceError) as caught:
        download(f"{web.url}/a", tmp_path / "file.part", Version(), lookup=confined())
    assert caught.value.code in ("source-outside", "source-fetch"), caught.value.message
    assert "leads to" in caught.value.message and len(web.asked) == 1
