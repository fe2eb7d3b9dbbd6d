"""Limit access to the server to pages that it served itself, by its address with the token."""

from __future__ import annotations

import hmac
from collections.abc import Sequence
from ipaddress import ip_address

from composer.dataclass import dataclass


@dataclass(frozen=True, slots=True)
class Guard:
    """Decides which requests the server answers. `host` and `port` are those that it is bound to."""

    host: str
    port: int
    token: str

    @property
    def address(self) -> str:
        shown = "127.0.0.1" if self._is_everywhere() else self.host
        return f"http://{_bracketed(shown)}:{self.port}/{self.token}/"

    def key_of(self, target: str, hosts: Sequence[str], origins: Sequence[str]) -> str | None:
        """Return what follows the token in the target of a request, or None if it must not be answered.

        `hosts` and `origins` are the values of all its headers of these names. A page of another site cannot set
        `Host`, and a browser sends its `Origin`, so both must be those of this server. A guard that fails refuses.
        """
        try:
            return self._key(target, hosts, origins)
        except Exception:
            return None

    def _key(self, target: str, hosts: Sequence[str], origins: Sequence[str]) -> str | None:
        if len(hosts) != 1 or len(origins) > 1:
            return None
        host = hosts[0].lower()
        if not self._is_everywhere() and host not in self._hosts():
            return None
        if origins and origins[0].lower() != f"http://{host}":
            return None
        own = f"/{self.token}/"
        head, key = target[: len(own)], target[len(own) :]
        return key if hmac.compare_digest(head.encode("utf-8", "surrogatepass"), own.encode()) else None

    def _is_everywhere(self) -> bool:
        """Return whether the server listens on all addresses of this machine."""
        try:
            return not self.host or ip_address(self.host).is_unspecified
        except ValueError:  # a name
            return False

    def _hosts(self) -> set[str]:
        names = {self.host, *(("localhost", "127.0.0.1", "::1") if _is_loopback(self.host) else ())}
        return {f"{_bracketed(name)}:{self.port}".lower() for name in names}


def _is_loopback(host: str) -> bool:
    return host in ("localhost", "::1") or host.startswith("127.")


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
