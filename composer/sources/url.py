"""Split web addresses; all code that parses them uses this module."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from urllib.parse import SplitResult


def take_apart(url: str, base: str = "") -> SplitResult | None:
    """Split an address, relative to `base`; return None if it has no valid host. No I/O.

    Python's own parser raises ValueError for unbalanced brackets, for a port that is not a number and for
    characters that normalize to `/` or `@`.

    >>> take_apart("https://host:8080/a.zip").port
    8080
    >>> take_apart("https://[::1/a.zip") is None
    True
    """
    from urllib.parse import urljoin, urlsplit  # most builds fetch nothing

    try:
        parts = urlsplit(urljoin(base, url))
        return parts if parts.hostname and parts.port != 0 else None
    except ValueError:
        return None
