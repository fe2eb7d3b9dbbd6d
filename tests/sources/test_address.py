"""One parser reads addresses as the libraries that connect, and a server that cannot be judged is private."""

from __future__ import annotations

import http.client
import socket
from contextlib import suppress
from ipaddress import IPv6Address
from typing import Any

import pytest
import urllib3
from hypothesis import given, settings, strategies as draw
from mjcompose.sources import address, connections
from mjcompose.sources.address import (
    AddressError,
    check_address,
    is_private,
    is_public,
    is_this_machine,
    resolved,
    take_apart,
)
from mjcompose.sources.connections import is_read_alike

FAULTS = [RecursionError, MemoryError, OSError, UnicodeError]


def fails(kind: type[Exception]) -> Any:
    def failing(*_: object, **__: object) -> Any:
        raise kind

    return failing


def answers(monkeypatch: pytest.MonkeyPatch, *addresses: str) -> None:
    address._addresses.cache_clear()
    there = [(socket.AF_INET, socket.SOCK_STREAM, 6, "", (each, 0)) for each in addresses]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: there)


@pytest.mark.parametrize(
    ("addresses", "expected"),
    [
        (["93.184.216.34"], False),
        (["10.0.0.7"], True),
        (["93.184.216.34", "192.168.1.1"], True),  # one of several is enough
        (["fd00::1"], True),
        (["::ffff:127.0.0.1"], True),
        (["what is this"], True),
    ],
)
def test_a_name_is_judged_by_its_addresses(
    monkeypatch: pytest.MonkeyPatch, addresses: list[str], expected: bool
) -> None:
    answers(monkeypatch, *addresses)
    assert is_private("robots.example.org:443") == expected
    assert not is_private("robots.example.org", offline=True)


def test_a_name_without_an_address_is_told_where_it_is_fetched(monkeypatch: pytest.MonkeyPatch) -> None:
    address._addresses.cache_clear()
    monkeypatch.setattr(socket, "getaddrinfo", fails(socket.gaierror))
    assert not is_private("nowhere.example.org")


@pytest.mark.parametrize("kind", FAULTS)
@pytest.mark.parametrize("inner", ["_literal", "_addresses", "is_this_machine"])
def test_a_server_that_cannot_be_judged_is_private(
    monkeypatch: pytest.MonkeyPatch, kind: type[Exception], inner: str
) -> None:
    monkeypatch.setattr(address, inner, fails(kind))
    assert is_private("robots.example.org") and (inner == "_addresses" or is_private("93.184.216.34"))


@pytest.mark.parametrize("kind", FAULTS)
def test_a_name_that_cannot_be_resolved_for_another_reason_is_private(
    monkeypatch: pytest.MonkeyPatch, kind: type[Exception]
) -> None:
    address._addresses.cache_clear()
    monkeypatch.setattr(socket, "getaddrinfo", fails(kind))
    assert is_private("robots.example.org")


@pytest.mark.parametrize(
    "url",
    [
        "https://[::1/a.zip",
        "https://℀.com/a.zip",
        "https://host:port/a",
        "https://host:0/a",
        "https:///a",
        "",
        r"https://127.0.0.1\@example.org/",
        r"https:\\example.org/",
        r"https://example.org/a\b",
        "https://a b.org/",
        "https://example.org/a b",
        "https://example.org/\t",
        "https://exa\nmple.org/",
        "https://example.org/\x7f",
        "https://example.org/\u200b",
        "https://example.org/\u00a0",
        " https://example.org/",
        "https://me@example.org/",
        "https://me:secret@example.org/",
        "https://@example.org/",
        "https://127.0.0.1#@example.org/@x:y@z/",
        "https://127.0.0.1%2f@example.org/",
        "https://%31%32%37.0.0.1/",
        "https://１２７.0.0.1/",
        "https://bücher.example/",
        "https://example.org:/",
        "https://example.org:99999/",
        "https://example.org:٣/",
        "https://[fe80::1%25eth0]/",
        "https://[v1.x]/",
        "https://[127.0.0.1]/",
        "https://example..org/",
        "https://.org/",
        "https://-x.org/",
        "https://example.org./",
        "ext::sh -c x",
        "file:///etc/passwd",
        "ssh://a:b@example.org/x",
        "ssh://-o@example.org/x",
        "gopher://example.org/",
        "//example.org/",
        "https://" + "a" * 64 + ".org/",
        "https://" + ".".join(["a" * 62] * 4) + "aaa/",
        "https://host:65536/",
        "https://x-.org/",
        "https://example.org:80:80/",
    ],
)
def test_what_is_no_address(url: str) -> None:
    if "#" not in url:  # the server does not get the fragment
        assert take_apart(url) is None
        with pytest.raises(AddressError):
            check_address(url)
    elif (parts := take_apart(url)) is not None:
        assert parts.hostname == "127.0.0.1"


@pytest.mark.parametrize(
    "url",
    [
        "https://" + "a" * 63 + ".org/",
        "https://" + ".".join(["a" * 62] * 4) + "a/",
        "https://host:65535/",
        "https://host:1/",
        "https://example.org/a.zip",
        "https://EXAMPLE.org:8443/a/b%20c?x=1&y=@v#z",
        "http://127.0.0.1:80/",
        "https://[::1]:9/",
        "ssh://git@example.org/x",
        "ssh://org-12.a@example.org:22/x",
        "https://xn--bcher-kva.example/é",
        "https://my_host/a",
    ],
)
def test_what_is_an_address(url: str) -> None:
    assert take_apart(url) is not None


def test_relative_ones() -> None:
    found = take_apart("../b.zip", "https://host:8080/x/y/a.zip")
    assert found is not None and found.geturl() == "https://host:8080/x/b.zip"
    assert take_apart("//[::1/b", "https://host/a") is None
    assert take_apart(r"//10.0.0.1\@host/b", "https://host/a") is None
    assert take_apart(r"/\10.0.0.1/b", "https://host/a") is None


PIECES = draw.sampled_from(
    [
        *"/\\@:?#[]%.;&=-_ \t\n\x00\x7f\u2028",
        "//",
        "127.0.0.1",
        "example.org",
        "[::1]",
        "0x7f",
        "1",
        "10",
        "a",
        "%40",
        "%2f",
        "%5c",
        "@example.org",
        ":80",
        "：",
        "／",
        "＠",
        "。",
        "１",
        "é",
        "xn--a",
        "localhost",
        "..",
        "\ud800",
    ]
)


def as_address(pieces: list[str]) -> str:
    return "https://" + "".join(pieces)


@settings(deadline=None)
@given(draw.lists(PIECES, max_size=12).map(as_address))
def test_urllib3_and_http_connect_to_the_host_that_is_judged(url: str) -> None:
    """The connections themselves say where they lead: to the host that this parser has found."""
    parts = take_apart(url)
    if parts is None:
        return
    assert is_read_alike(url), url
    pool = urllib3.PoolManager().connection_from_url(url)
    assert (pool.host.strip("[]"), pool.port) == (parts.hostname, parts.port or 443), url
    plain = http.client.HTTPSConnection(parts.netloc)
    assert (plain.host.lower(), plain.port) == (parts.hostname, parts.port or 443), url
    assert take_apart(parts.geturl()) == parts


@pytest.mark.parametrize(
    "url",
    [
        "https://127.0.0.1:9/a",
        "https://EXAMPLE.org/b?x=https://other.org/@y",
        "https://[::1]:9/",
        "https://2130706433/",
    ],
)
def test_what_is_looked_up_is_what_is_judged(url: str, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    def lookup(host: str, *_: object, **__: object) -> Any:
        asked.append(host)
        raise socket.gaierror

    monkeypatch.setattr(socket, "getaddrinfo", lookup)
    parts = take_apart(url)
    assert parts is not None
    with suppress(urllib3.exceptions.HTTPError):
        urllib3.PoolManager().request("GET", url, retries=False)
    assert asked == [parts.hostname]


@pytest.mark.parametrize(
    "host",
    [
        "127.1",
        "127.0.1",
        "0177.0.0.1",
        "0x7f.0.0.1",
        "0x7f000001",
        "2130706433",
        "017700000001",
        "00127.0.0.1",
        "127.0.0.1.",
        "1.2.3.256",
        "1.2.3.4.5",
        "8.8.2056",
        "0x8.8.8.8",
        "08.8.8.8",
        "a.1",
        "0X7F.1",
        "0.0.0.0",
        "10.0.0.7",
        "100.64.0.1",
        "127.255.255.254",
        "169.254.169.254",
        "172.31.0.1",
        "192.0.0.192",
        "192.168.0.1",
        "198.19.0.1",
        "224.0.0.1",
        "239.255.255.250",
        "240.0.0.1",
        "255.255.255.255",
        "168.63.129.16",
        "192.88.99.1",
        "[::]",
        "[::1]",
        "[::127.0.0.1]",
        "[::8.8.8.8]",
        "[::ffff:127.0.0.1]",
        "[::ffff:0:127.0.0.1]",
        "[64:ff9b::127.0.0.1]",
        "[64:ff9b::a00:1]",
        "[64:ff9b:1::a00:1]",
        "[64:ff9b:1:fffe::7f00:1]",
        "[2002:7f00:1::]",
        "[2002:808:808::1]",
        "[2001:0:4136:e378:8000:63bf:3fff:fdd2]",
        "[2001:10::1]",
        "[2001:db8::1]",
        "[fec0::1]",
        "[feff::1]",
        "[fc00::1]",
        "[fdff::1]",
        "[fe80::1]",
        "[febf::1]",
        "[ff02::1]",
        "[100::1]",
        "[2606:4700::5efe:10.0.0.1]",
        "[5f00::1]",
        "192.0.2.1",
        "198.51.100.1",
        "203.0.113.1",
        "172.16.0.0",
        "172.31.255.255",
        "100.127.255.255",
        "198.18.0.1",
        "169.254.255.255",
        "192.168.255.255",
        "10.255.255.255",
        "0.255.255.255",
        "224.255.0.1",
        "[3fff::1]",
        "[3fff:fff::1]",
        "[2001:1ff::1]",
        "[2002:ffff:ffff::1]",
        "[2001:db8:ffff::1]",
        "[4000::1]",
        "[1fff::1]",
        "[::ffff:8.8.8.8]",
        *(f"robots{suffix}" for suffix in address._LOCAL),
        "robots.corp",
        "robots.home.arpa",
        "robots.localdomain",
        "localhost",
        "a.localhost",
        "nas",
        "nas.local",
        "db.internal",
        "LOCALHOST",
        "x.LAN",
        "",
    ],
)
def test_a_server_of_this_network(host: str) -> None:
    assert is_private(host, offline=True) and is_private(f"{host}:443", offline=True)


@pytest.mark.parametrize(
    "host", ["8.8.8.8", "[2606:4700::1111]", "[2a00:1450:4001:830::200e]", "example.org", "1.example.org"]
)
def test_a_server_of_the_internet(host: str) -> None:
    assert not is_private(host, offline=True) and not is_private(f"{host}:443", offline=True)


@given(draw.ip_addresses(v=4))
def test_an_address_in_another_is_never_public(inner: Any) -> None:
    """Nor is one that Python calls private, in any form."""
    number = int(inner)
    for outer in (
        number,
        0xFFFF << 32 | number,
        0x64FF9B << 96 | number,
        0x2002 << 112 | number << 80,
        0x64FF9B0001 << 80 | number,
    ):
        assert not is_public(address.IPv6Address(outer)), address.IPv6Address(outer)
    if not inner.is_global or inner.is_multicast:
        assert not is_public(inner)


@given(draw.ip_addresses(v=6))
def test_no_address_is_public_that_python_calls_private(found: Any) -> None:
    if not found.is_global or found.is_multicast or found.is_site_local or found.sixtofour or found.teredo:
        assert not is_public(found)


def test_a_network_that_translates_has_public_servers(monkeypatch: pytest.MonkeyPatch) -> None:
    """In a network of IPv6 alone, DNS gives an address of NAT64 for a server of IPv4; which one, is judged."""
    answers(monkeypatch, "64:ff9b::808:808")
    assert not is_private("robots.example.org")
    answers(monkeypatch, "64:ff9b::a00:1")
    assert is_private("robots.example.org")


@pytest.mark.parametrize(
    ("netloc", "expected"),
    [
        ("localhost", True),
        ("localhost:80", True),
        ("127.0.0.1", True),
        ("127.3.2.1:9", True),
        ("[::1]:9", True),
        ("127.1", False),
        ("127.0.0.256", False),
        ("127.0.0.1.example.org", False),
        ("me@localhost", False),
        ("[::2]", False),
        ("localhost.example.org", False),
        ("127.0.0.1\\@host", False),
    ],
)
def test_this_machine(netloc: str, expected: bool) -> None:
    assert is_this_machine(netloc) == expected


def test_only_this_machine_is_this_machine() -> None:
    """Such a server needs no encryption, so a name that only looks like it must not count."""
    assert all(map(is_this_machine, ("localhost", "localhost:80", "127.0.0.1", "127.8.8.8:1", "[::1]:80")))
    others = (
        "x.localhost",
        "notlocalhost",
        "localhost.example.org",
        "LOCALHOST",
        "me@localhost",
        "0.0.0.0",
        "[::]",
        "",
    )
    assert not any(map(is_this_machine, others))


def test_the_zone_of_an_address_is_dropped() -> None:
    """The two ends of a connection are compared, and a zone is the name of an interface."""
    assert resolved("fe80::1%eth0") == resolved("fe80::1%3") == IPv6Address("fe80::1")


@pytest.mark.parametrize(
    "read",
    [{"auth": "me"}, {"port": 8443}, {"host": "other.example"}, {"scheme": "http"}],
    ids=lambda read: next(iter(read)),
)
def test_an_address_that_urllib3_reads_in_another_way_is_refused(
    monkeypatch: pytest.MonkeyPatch, read: dict[str, Any]
) -> None:
    url = "https://robots.example:443/arm.xml"
    assert is_read_alike(url)
    monkeypatch.setattr(connections, "parse_url", lambda text: urllib3.util.parse_url(text)._replace(**read))
    assert not is_read_alike(url)
