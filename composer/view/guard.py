"""Limit access to the server to pages that it served itself, by its address with the token."""

from __future__ import annotations

import hmac
from collections.abc import Mapping
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

    def _is_everywhere(self) -> bool:
        """Return whether the server listens on all addresses of this machine."""
        try:
            return not self.host or ip_address(self.host).is_unspecified
        except ValueError:  # a name
            return False

    def path_of(self, path: str, headers: Mapping[str, str]) -> str | None:
        """Return the path below the token, or None if the request must not be answered.

        `headers` are keyed by lower-case names. A page of another site cannot set `Host`, and a browser sends its
        `Origin`, so both must be those of this server.
        """
        host = headers.get("host", "").lower()
        if not self._is_everywhere() and host not in self._hosts():
            return None
        origin = headers.get("origin")
        if origin is not None and origin.lower() != f"http://{host}":
            return None
        token, slash, rest = path.partition("?")[0].removeprefix("/").partition("/")
        if not slash or not hmac.compare_digest(token.encode(), self.token.encode()):
            return None
        return rest

    def _hosts(self) -> set[str]:
        names = {self.host, *(("localhost", "127.0.0.1", "::1") if _is_loopback(self.host) else ())}
        return {f"{_bracketed(name)}:{self.port}".lower() for name in names}


def _is_loopback(host: str) -> bool:
    return host in ("localhost", "::1") or host.startswith("127.")


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host
