"""Compare MuJoCo versions."""

from __future__ import annotations


def exists_in(version: str, since: str | None, until: str | None) -> bool:
    """Return whether `version` is between the first and the last version, both included; `None` is open.

    >>> exists_in("3.17.0", "3.13.0", None), exists_in("4.0.0", None, "3.17.0")
    (True, False)
    """
    if since is None and until is None:
        return True
    key = version_key(version)
    return (since is None or version_key(since) <= key) and (until is None or key <= version_key(until))


def version_key(version: str) -> tuple[int, ...]:
    """Return the numbers of a dotted version, for comparison, without a suffix such as `rc1`.

    >>> version_key("3.12.0") < version_key("4.0.0rc1")
    True
    """
    numbers = []
    for part in version.split("."):
        digits = part[: len(part) - len(part.lstrip("0123456789"))]
        if not digits:
            break
        numbers.append(int(digits))
    return tuple(numbers)
