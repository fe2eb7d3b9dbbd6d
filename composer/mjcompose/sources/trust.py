"""The files and servers of this machine that models and fetched recipes may reach."""

from __future__ import annotations

import ipaddress
import os
import re
from functools import cache
from pathlib import Path

from mjcompose.base.dataclass import dataclass
from mjcompose.sources.reference import Origin, Reference, SourceError, SourceKind, is_this_machine


@dataclass(frozen=True, slots=True)
class Trust:
    """The files and references that the outer recipe trusts.

    `files` are folders that the user's own models may read; fetched recipes may name `references`. A
    reference is allowed if it is one of `references`, or continues one of them after a separator:

    >>> trust = Trust(references=("git+file:///srv/robots", "package:arms"))
    >>> trust.allows("git+file:///srv/robots@v1#arm.xml"), trust.allows("package:armsdealer/arm.xml")
    (True, False)
    """

    files: tuple[Path, ...] = ()
    references: tuple[str, ...] = ()

    def with_more(self, other: Trust) -> Trust:
        """Return the union of both."""
        return Trust(
            tuple(dict.fromkeys((*self.files, *other.files))),
            tuple(dict.fromkeys((*self.references, *other.references))),
        )

    def allows(self, reference: str) -> bool:
        """Return whether a fetched recipe may contain the reference. No I/O."""
        if _LEADS_OUT.search(reference):  # leads out of the allowed folder
            return False
        return any(_begins(reference, each) for each in self.references)

    @property
    def folders(self) -> tuple[str, ...]:
        """The references that are absolute paths: the folders of this machine that fetched recipes may read."""
        return tuple(each for each in self.references if os.path.isabs(each))


_LEADS_OUT = re.compile(r"(^|[/\\])(\.|%2e){2}([/\\]|$)", re.IGNORECASE)
_SEPARATORS = "/:@#"


def _begins(text: str, start: str) -> bool:
    rest = text[len(start) :]
    return text.startswith(start) and (not rest or start[-1] in _SEPARATORS or rest[0] in _SEPARATORS)


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
    except Exception:  # a guard that fails refuses
        what = "something that mjcompose cannot check"
    else:
        what = "something on this machine" if host is None else f"`{host}`, which is on this machine or in its network"
    message = f"`{reference.text}` names {what}, and `{origin.id}`, whose recipe does, was fetched"
    trusted = reference.text if reference.kind.is_local else reference.id
    help = f'if you trust it with that, write in your own recipe `trust: {{references: ["{trusted}"]}}`'
    raise SourceError("source-outside", message, help=help)


def is_private(host: str, offline: bool = False) -> bool:
    """Return whether a server is on this machine or in its network; a name is resolved unless `offline`.

    So is a server that cannot be checked. A server without an address is not: nothing can be fetched from it.

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
        return (isinstance(found, ipaddress.IPv6Address) and found.ipv4_mapped) or found
    if not re.fullmatch(r"(0x[0-9a-f]*|\d+)(\.(0x[0-9a-f]*|\d+)){0,3}", text):
        return None
    try:
        return ipaddress.IPv4Address(socket.inet_aton(text))
    except OSError:
        return None


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
