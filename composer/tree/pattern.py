"""What a pattern over names means: a name, a glob, or a regular expression with a time limit."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Collection

from composer.tree.glob import is_glob, matcher

SECONDS = 2.0
# In a child process, as nothing else stops Python's `re` on every system and in every thread.
_CHILD = (
    "import json, re, sys\n"
    "pattern, names = json.load(sys.stdin)\n"
    "fits = re.compile(pattern).fullmatch\n"
    "json.dump([name for name in names if fits(name)], sys.stdout)\n"
)


class BadPattern(Exception):
    """A pattern that cannot be used: `message` says why, `help` what to write."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.message, self.help = message, help


def is_regular(pattern: str) -> bool:
    """Whether it is written as a regular expression, `/…/`."""
    return len(pattern) > 2 and pattern.startswith("/") and pattern.endswith("/")


def is_pattern(text: str) -> bool:
    """Whether a text means names by a glob or a regular expression, and not the one name that it is."""
    return is_glob(text) or is_regular(text)


def fitter(pattern: str, names: Callable[[], Collection[str]], separator: str) -> Callable[[str], bool]:
    """Whether a name is meant by a pattern. Raises `BadPattern`.

    A regular expression is tried on all the `names` at once: each attempt takes a process of its own.

    >>> pads = fitter("*/pad?", list, "/")
    >>> pads("left/pad1"), pads("pad1")
    (True, False)
    """
    if not is_regular(pattern):
        return matcher(pattern, separator)
    return fitting(pattern[1:-1], names()).__contains__


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
    """The names that the whole expression fits. Raises `BadPattern` where it is not valid, and after `seconds`."""
    import subprocess  # few programs that look up names in an index need it

    if (wrong := fault_of(pattern)) is not None:
        raise BadPattern(f"the regular expression `/{pattern}/` is not valid: {wrong}")
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
        raise BadPattern(
            f"the regular expression `/{pattern}/` takes longer than {SECONDS:g} seconds",
            "write it without repetitions inside repetitions, or use a glob",
        ) from None
    return frozenset(json.loads(done.stdout))
