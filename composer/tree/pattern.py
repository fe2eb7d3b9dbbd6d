"""Patterns over names: a name, a glob, or a regular expression.

A regular expression may take time exponential in the length of a name, and Python's `re` cannot be interrupted on
every system and in every thread. Expressions that may take long run in a process of their own, with a time limit.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Collection
from typing import Any

from composer.tree.glob import is_glob, matcher

SECONDS = 2.0
_LONGEST = 10_000
_CHILD = (
    "import json, re, sys\n"
    "pattern, names = json.load(sys.stdin)\n"
    "fits = re.compile(pattern).fullmatch\n"
    "json.dump([name for name in names if fits(name)], sys.stdout)\n"
)


_REPEATS, _GOES_BACK = re.compile(r"[*+{]"), re.compile(r"[*+?{|]")
_REPEATED_GROUP_OR_REFERENCE = re.compile(r"\)[*+?{]|\(\?|\\\d")
_CHOICES = 8
"""The maximum number of choice operators in an expression that runs here: the tries are two to the power of it."""


class BadPattern(Exception):
    """An unusable pattern: `message` says why, `help` what to write; `is_slow` says that it took too long."""

    def __init__(self, message: str, help: str | None = None, *, is_slow: bool = False) -> None:
        super().__init__(message)
        self.message, self.help, self.is_slow = message, help, is_slow


class TooSlow(Exception):
    """A process took longer than allowed."""


def is_regular(pattern: str) -> bool:
    """Return whether it is written as a regular expression, `/…/`."""
    return len(pattern) > 2 and pattern.startswith("/") and pattern.endswith("/")


def is_pattern(text: str) -> bool:
    """Return whether a text is a glob or a regular expression, and not a single name."""
    return is_glob(text) or is_regular(text)


def fitter(pattern: str, names: Callable[[], Collection[str]], separator: str) -> Callable[[str], bool]:
    """Return a function that says whether a name matches a pattern. Raises `BadPattern`.

    A regular expression is matched with all the `names` at once, because each attempt needs a process.

    >>> pads = fitter("*/pad?", list, "/")
    >>> pads("left/pad1"), pads("pad1")
    (True, False)
    """
    if (wrong := length_fault(pattern)) is not None:
        raise BadPattern(wrong)
    if not is_regular(pattern):
        return matcher(pattern, separator)
    return fitting(pattern[1:-1], names()).__contains__


def length_fault(pattern: str) -> str | None:
    """Return that a pattern is too long, or None if it is not.

    >>> length_fault("{left,right}/*"), length_fault("*" * 10_001)
    (None, 'a pattern of 10001 characters is too long; 10000 are allowed')
    """
    if len(pattern) <= _LONGEST:
        return None
    return f"a pattern of {len(pattern)} characters is too long; {_LONGEST} are allowed"


def fault_of(pattern: str) -> str | None:
    """Return the error in a regular expression, given without its slashes.

    >>> fault_of("link[0-9]+"), fault_of("link[0-9")
    (None, 'unterminated character set')
    """
    try:
        re.compile(pattern)
    except (re.error, OverflowError, RecursionError) as error:
        return str(getattr(error, "msg", error))
    return None


def is_quick(pattern: str) -> bool:
    """Return whether a regular expression, without its slashes, never takes long: it repeats once, and no group.

    >>> is_quick("link_[0-9]+"), is_quick("(left|right)_.*"), is_quick("(a+)+"), is_quick("a*b*")
    (True, True, False, False)
    """
    if len(_REPEATS.findall(pattern)) > 1 or _REPEATED_GROUP_OR_REFERENCE.search(pattern):
        return False
    return len(_GOES_BACK.findall(pattern)) <= _CHOICES


def takes_process(pattern: str) -> bool:
    """Return whether a pattern is a regular expression that needs a process of its own."""
    return is_regular(pattern) and not is_quick(pattern[1:-1])


def fitting(pattern: str, names: Collection[str], seconds: float = SECONDS) -> frozenset[str]:
    """Return the names that the whole expression matches. Raises `BadPattern` if it is invalid, or after `seconds`."""
    if (wrong := fault_of(pattern)) is not None:
        raise BadPattern(f"the regular expression `/{pattern}/` is not valid: {wrong}")
    if is_quick(pattern):
        return frozenset(filter(re.compile(pattern).fullmatch, names))
    try:
        return frozenset(asked_aside(_CHILD, [pattern, sorted(names)], seconds))
    except TooSlow:
        raise BadPattern(
            f"the regular expression `/{pattern}/` takes longer than {SECONDS:g} seconds",
            "write it without repetitions inside repetitions, or use a glob",
            is_slow=True,
        ) from None


def asked_aside(program: str, question: object, seconds: float = SECONDS) -> Any:
    """Run a Python program in a process of its own, with JSON as input and output. Raises `TooSlow` after `seconds`."""
    import subprocess  # few programs that look up names in an index need it

    from composer.processes.process import Process

    with Process(
        [sys.executable, "-I", "-S", "-c", program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            answer, _ = process.communicate(json.dumps(question), timeout=seconds)
        except subprocess.TimeoutExpired:
            raise TooSlow from None
        finally:
            process.end()
    return json.loads(answer)
