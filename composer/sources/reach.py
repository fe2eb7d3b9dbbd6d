"""Limit what fetched recipes may name: nothing on this machine or its network that the outer recipe does not trust."""

from __future__ import annotations

import ipaddress
import re
from functools import cache

from composer.sources.error import SourceError
from composer.sources.origin import Origin
from composer.sources.reference import Reference, is_this_machine
from composer.sources.source_kind import SourceKind
from composer.sources.trust import Trust

_LOCAL = (".local", ".localhost", ".internal", ".lan", ".home", ".intranet", ".corp", ".home.arpa")
"""Suffixes of names that only the local network knows."""


def check_reach(reference: Reference, kind: SourceKind, origin: Origin, trust: Trust, offline: bool) -> None:
    """Refuse a reference that a recipe fetched with `origin` may not name. Raises SourceError."""
    host = None
    try:
        if trust.allows(reference.text):
            return
        host = kind.host(reference)
        if host is None and not kind.is_of_this_machine(reference):
            return
        if host is not None and not is_private(host, offline):
            return
    except Exception:  # what cannot be judged is refused
        what = "what cannot be judged"
    else:
        what = (
            "something on this machine"
            if host is None
            else f"`{host}`, which is on this machine or in its network"
        )
    raise SourceError(
        "source-outside",
        f"`{reference.text}` names {what}, and `{origin.id}`, whose recipe does, was fetched",
        help=f'if you trust it with that, write in your own recipe `trust: {{references: ["{_prefix(reference)}"]}}`',
    )


def is_private(host: str, offline: bool = False) -> bool:
    """Return whether a server is on this machine or in its network; a name is resolved unless `offline`.

    So is one that cannot be judged. One whose name has no address is not: nothing can be fetched from it.

    >>> [is_private(host, True) for host in ("localhost:80", "10.1.2.3", "git@[::1]", "example.org", "nas")]
    [True, True, True, False, True]
    """
    try:
        host = host.rpartition("@")[2]
        if is_this_machine(host):
            return True
        name = re.sub(r":\d*$", "", host).strip("[]").rstrip(".").lower()
        if (address := _address(name)) is not None:
            return not address.is_global
        if "." not in name or name.endswith(_LOCAL):
            return True
        return not offline and any(not each.is_global for each in _addresses(name))
    except Exception:
        return True


def _address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """Parse an IP address, including the forms that a resolver accepts: `127.1`, `0x7f000001`, `2130706433`."""
    import socket

    try:
        found = ipaddress.ip_address(text.partition("%")[0])
    except ValueError:
        pass
    else:
        return _inner(found)
    if not re.fullmatch(r"(0x[0-9a-f]*|\d+)(\.(0x[0-9a-f]*|\d+)){0,3}", text):
        return None
    try:
        return ipaddress.IPv4Address(socket.inet_aton(text))
    except OSError:
        return None


def _inner(
    address: ipaddress.IPv4Address | ipaddress.IPv6Address,
) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """Return the IPv4 address that an IPv6 address maps, or the address itself."""
    return (isinstance(address, ipaddress.IPv6Address) and address.ipv4_mapped) or address


@cache
def _addresses(name: str) -> tuple[ipaddress.IPv4Address | ipaddress.IPv6Address, ...]:
    """Return the addresses of a name; none if it cannot be resolved, which is reported when it is fetched."""
    import socket

    try:
        found = socket.getaddrinfo(name, None, proto=socket.IPPROTO_TCP)
    except socket.gaierror:
        return ()
    addresses = [_address(str(each[4][0])) for each in found]
    if None in addresses:
        raise ValueError(name)
    return tuple(each for each in addresses if each is not None)


def _prefix(reference: Reference) -> str:
    return reference.id if not reference.kind.is_local else reference.text
