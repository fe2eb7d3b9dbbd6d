"""Regular expressions over names, with a bound: no pattern can keep a build waiting."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Collection

SECONDS = 2.0
# In a child process, as nothing else stops Python's `re` on every system and in every thread.
_CHILD = (
    "import json, re, sys\n"
    "pattern, names = json.load(sys.stdin)\n"
    "fits = re.compile(pattern).fullmatch\n"
    "json.dump([name for name in names if fits(name)], sys.stdout)\n"
)


class SlowPattern(Exception):
    """The expression took longer than it was given."""

    help = "write it without repetitions inside repetitions, or use a glob"

    @property
    def message(self) -> str:
        return f"the regular expression `/{self}/` takes longer than {SECONDS:g} seconds"


def is_regular(pattern: str) -> bool:
    """Whether it is written as a regular expression, `/…/`."""
    return len(pattern) > 2 and pattern.startswith("/") and pattern.endswith("/")


def fault_of(pattern: str) -> str | None:
    """What is wrong with the text of a regular expression between its slashes.

    >>> fault_of("link[0-9]+"), fault_of("link[0-9")
    (None, 'unterminated character set')
    """
    try:
        re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as error:
        return str(getattr(error, "msg", error))
    return None


def fitting(pattern: str, names: Collection[str], seconds: float = SECONDS) -> frozenset[str]:
    """The names that the whole expression fits; raises `SlowPattern` after `seconds`."""
    try:
        done = subprocess.run(
            [sys.executable, "-I", "-S", "-c", _CHILD],
            input=json.dumps([pattern, sorted(names)]),
            capture_output=True,
            text=True,
            timeout=seconds,
            check=True,
        )
    except subprocess.TimeoutExpired:
        raise SlowPattern(pattern) from None
    return frozenset(json.loads(done.stdout))
