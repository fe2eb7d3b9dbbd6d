r"""Addresses of servers: the one parser of all of them, and the check whether a server is public.

`urllib.parse`, `urllib3`, curl and ssh read unusual addresses differently, so only addresses that all of them read
alike are accepted: ASCII hosts, no user name except for ssh, no `\\`, no white space and no control characters.
"""

from __future__ import annotations

import re
from functools import cache
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from urllib.parse import SplitResult

IpAddress: TypeAlias = IPv4Address | IPv6Address


class AddressError(ValueError):
    """The text is not an address of a server; the message continues a sentence about it."""


DEFAULT_PORTS = {"http": 80, "https": 443, "ssh": 22}
_AUTHORITY = re.compile(r"((?P<user>[^@]*)@)?(?P<host>\[[0-9A-Fa-f:.]+\]|[^\[\]:@]+)(:(?P<port>[0-9]{1,5}))?")
_USER = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+~-]*")
_LABEL = re.compile(r"[a-z0-9_]([a-z0-9_-]{0,61}[a-z0-9_])?", re.IGNORECASE)
_LONGEST_NAME = 253
_LARGEST_PORT = 65535
_NO_HOST = "names a host that cannot be one"


def take_apart(url: str, base: str = "") -> SplitResult | None:
    r"""Split an address, relative to `base`; return None if programs could read it differently. No I/O.

    >>> take_apart("https://host:8080/a.zip").port
    8080
    >>> take_apart("https://[::1/a.zip") is None, take_apart("https://10.0.0.1\\@host/a.zip") is None
    (True, True)
    """
    try:
        return _split(url, base)
    except AddressError:
        return None


def check_address(url: str) -> None:
    """Raise AddressError if `take_apart` returns None for an address."""
    _split(url, "")


def _split(url: str, base: str) -> SplitResult:
    from urllib.parse import urljoin, urlsplit  # most builds fetch nothing

    if "\\" in url:
        raise AddressError(r"contains a `\`")
    if not all(character.isprintable() and not character.isspace() for character in url):
        raise AddressError("contains white space or a control character")
    try:
        parts = urlsplit(urljoin(base, url))
        port = parts.port
    except ValueError:
        raise AddressError(_NO_HOST) from None
    authority = _AUTHORITY.fullmatch(parts.netloc)
    if authority is None or parts.scheme not in DEFAULT_PORTS:
        raise AddressError(_NO_HOST)
    if port is not None and not 0 < port <= _LARGEST_PORT:
        raise AddressError(_NO_HOST)
    user = authority["user"]
    if user is not None and (parts.scheme != "ssh" or not _USER.fullmatch(user)):
        raise AddressError("contains a user name")
    if not _is_host(authority["host"]):
        raise AddressError(_NO_HOST)
    return parts


def _is_host(host: str) -> bool:
    if host.startswith("["):
        try:
            IPv6Address(host[1:-1])
        except ValueError:
            return False
        return True
    return len(host) <= _LONGEST_NAME and all(_LABEL.fullmatch(label) for label in host.split("."))


def is_this_machine(netloc: str) -> bool:
    """Return whether a host, with or without a port, is the loopback, which needs no encryption. No I/O."""
    authority = _AUTHORITY.fullmatch(netloc)
    if authority is None or authority["user"] is not None:
        return False
    try:
        address = _literal(authority["host"])
    except ValueError:
        return False
    return authority["host"] == "localhost" if address is None else address.is_loopback


_LOCAL = (
    ".local",
    ".localhost",
    ".localdomain",
    ".internal",
    ".lan",
    ".home",
    ".intranet",
    ".corp",
    ".private",
    ".home.arpa",
)
"""Suffixes of names that only the local network knows."""


def is_private(netloc: str, offline: bool = False) -> bool:
    """Return whether a server is on this machine or in its network; a name is resolved unless `offline`.

    A server that cannot be checked counts as private. A server without an address does not, because nothing can be
    fetched from it.

    >>> [is_private(host, True) for host in ("localhost:80", "10.1.2.3", "git@[::1]", "example.org", "nas", "0x7f.1")]
    [True, True, True, False, True, True]
    """
    try:
        authority = _AUTHORITY.fullmatch(netloc)
        if authority is None or not _is_host(authority["host"]) or is_this_machine(netloc):
            return True
        name = authority["host"].lower()
        address = _literal(name)
        if address is not None:
            return not is_public(address)
        if "." not in name or name.endswith(_LOCAL):
            return True
        return not offline and not all(is_public(each) for each in _addresses(name))
    except Exception:  # a guard that fails refuses
        return True


def addresses_of(netloc: str) -> tuple[IpAddress, ...]:
    """Return the addresses of a server; none if its name cannot be resolved. Raises ValueError and OSError."""
    authority = _AUTHORITY.fullmatch(netloc)
    if authority is None:
        raise ValueError(netloc)
    name = authority["host"].lower()
    address = _literal(name)
    return _addresses(name) if address is None else (address,)


_NUMBER = re.compile(r"[0-9]+|0x[0-9a-f]*", re.IGNORECASE)


def _literal(host: str) -> IpAddress | None:
    """Return the IP address that a host is, or None for a name.

    Resolvers also take `127.1`, `0177.0.0.1`, `0x7f000001` and `2130706433`, each in its own way. Raises ValueError
    for these, and for all other names whose last label is a number, which no server of the internet has.
    """
    if host.startswith("["):
        return IPv6Address(host[1:-1])
    if _NUMBER.fullmatch(host.rpartition(".")[2]) is None:
        return None
    return IPv4Address(host)


@cache
def _addresses(name: str) -> tuple[IpAddress, ...]:
    """Return the addresses of a name; none if it cannot be resolved, which is reported when it is fetched."""
    import socket

    try:
        answers = socket.getaddrinfo(name, None, proto=socket.IPPROTO_TCP)
    except socket.gaierror:
        return ()
    return tuple(dict.fromkeys(resolved(str(answer[4][0])) for answer in answers))


_TRANSLATED = IPv6Network("64:ff9b::/96")
"""Addresses of NAT64 (RFC 6052): DNS gives them for servers that have IPv4 alone, in a network that has IPv6 alone."""


def resolved(text: str) -> IpAddress:
    """Return an address from the system: the IPv4 address for one that stands for it. Raises ValueError.

    >>> resolved("64:ff9b::808:808"), resolved("::ffff:10.0.0.1")
    (IPv4Address('8.8.8.8'), IPv4Address('10.0.0.1'))
    """
    address = ip_address(text.partition("%")[0])
    if isinstance(address, IPv4Address):
        return address
    if address.ipv4_mapped is not None:
        return address.ipv4_mapped
    return IPv4Address(int(address) & 0xFFFFFFFF) if address in _TRANSLATED else address


_GLOBAL = IPv6Network("2000::/3")
"""The only part of IPv6 that IANA gives to networks. IPv4 addresses written as IPv6, site-local, unique local,
link-local and multicast addresses are outside."""
_NOT_PUBLIC = tuple(
    IPv4Network(each)
    for each in (
        "0.0.0.0/8",
        "10.0.0.0/8",
        "100.64.0.0/10",
        "127.0.0.0/8",
        "169.254.0.0/16",
        "172.16.0.0/12",
        "192.0.0.0/24",
        "192.0.2.0/24",
        "192.88.99.0/24",
        "192.168.0.0/16",
        "198.18.0.0/15",
        "198.51.100.0/24",
        "203.0.113.0/24",
        "224.0.0.0/4",
        "240.0.0.0/4",
        "168.63.129.16/32",  # the host of a virtual machine of Azure, which gives it its secrets
    )
)
_NOT_PUBLIC_6 = tuple(
    IPv6Network(each)
    for each in (
        "2001::/23",  # Teredo, which carries IPv4, and other protocols
        "2001:db8::/32",
        "3fff::/20",  # for documentation
        "2002::/16",  # 6to4, which carries IPv4
    )
)
_ISATAP = (0x00005EFE, 0x02005EFE)


def is_public(address: IpAddress) -> bool:
    """Return whether an IP address is outside of this machine and its network.

    The lists are ours, because `is_global` differs between versions of Python and admits multicast and 6to4. An
    IPv6 address that carries an IPv4 address is not public, whatever it carries: few servers are written so.
    """
    if isinstance(address, IPv4Address):
        return not any(address in network for network in _NOT_PUBLIC)
    if address not in _GLOBAL or any(address in network for network in _NOT_PUBLIC_6):
        return False
    return int(address) >> 32 & 0xFFFFFFFF not in _ISATAP
