"""The timeout for silence of another machine."""

from __future__ import annotations

import time
from collections.abc import Mapping

from composer.sources.error import SourceError

DEFAULT = 30.0
_SHORTEST, _LONGEST = 0.1, 24 * 3600.0


def patience(environment: Mapping[str, str]) -> float:
    """Return the timeout in seconds from `MJCOMPOSE_TIMEOUT`. Raises SourceError for an invalid value.

    >>> patience({}), patience({"MJCOMPOSE_TIMEOUT": "2.5"})
    (30.0, 2.5)
    """
    written = environment.get("MJCOMPOSE_TIMEOUT", "")
    if not written:
        return DEFAULT
    try:
        seconds = float(written)
    except ValueError:
        seconds = 0.0
    if not _SHORTEST <= seconds <= _LONGEST:
        raise SourceError(
            "source-fetch",
            f"`MJCOMPOSE_TIMEOUT` is not a number of seconds from {_SHORTEST} to {_LONGEST:.0f}: `{written}`",
            help="write it as `30`",
        )
    return seconds


class Silence:
    """Measures how long another machine has been silent, over all tries together; `seconds` is the limit."""

    def __init__(self, seconds: float) -> None:
        self._seconds = seconds
        self._since = time.monotonic()

    @property
    def left(self) -> float:
        """Remaining seconds; never zero, because a time limit of zero has another meaning."""
        return max(self._seconds - (time.monotonic() - self._since), 0.01)

    @property
    def is_nearly_over(self) -> bool:
        """Whether too little time is left for another try."""
        return self.left < self._seconds / 4

    @property
    def is_over(self) -> bool:
        return time.monotonic() - self._since >= self._seconds

    def broken(self) -> None:
        """Restart the measurement after the machine has answered."""
        self._since = time.monotonic()
