"""Patterns over names: a name, a glob, or a regular expression.

A regular expression may take time exponential in the length of a name, and Python's `re` cannot be interrupted. The
package `regex` can. It is imported for a recipe with a regular expression only.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Collection

from composer.tree.glob import is_glob, matcher

SECONDS = 2.0
"""How much of the processor's time the names of a model may take with one expression."""
_LONGEST = 10_000
# Of what Python's `re` takes as text, and `regex` as errors in a name (`{e<=1}`) or a POSIX class.
_MEANT_AS_TEXT = re.compile(r"(\\N\{[^}]*\}|\\.)|(\{(?!\d*,?\d*\})|(?<=\[)\[(?=:))", re.DOTALL)


class BadPattern(Exception):
    """An unusable pattern: `message` says why, `help` what to write; `is_slow` says that it took too long."""

    def __init__(self, message: str, help: str | None = None, *, is_slow: bool = False) -> None:
        super().__init__(message)
        self.message, self.help, self.is_slow = message, help, is_slow


def is_regular(pattern: str) -> bool:
    """Return whether it is written as a regular expression, `/…/`."""
    return len(pattern) > 2 and pattern.startswith("/") and pattern.endswith("/")


def is_pattern(text: str) -> bool:
    """Return whether a text is a glob or a regular expression, and not a single name."""
    return is_glob(text) or is_regular(text)


def fitter(pattern: str, names: Callable[[], Collection[str]], separator: str) -> Callable[[str], bool]:
    """Return a function that says whether a name matches a pattern. Raises `BadPattern`.

    A regular expression is matched with all the `names` at once, which have its time together.

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


def fitting(pattern: str, names: Collection[str], seconds: float = SECONDS) -> frozenset[str]:
    """Return the names that the whole expression matches. Raises `BadPattern` if it is invalid, or after `seconds`.

    >>> sorted(fitting("link[0-9]+|pad{e}", ["link1", "link12", "pad", "pad{e}"]))
    ['link1', 'link12', 'pad{e}']
    """
    if (wrong := fault_of(pattern)) is not None:
        raise BadPattern(f"the regular expression `/{pattern}/` is not valid: {wrong}")
    import regex  # takes 40 ms

    end = time.process_time() + seconds  # which `regex` measures, too
    found = set()
    try:
        fits = regex.compile(_MEANT_AS_TEXT.sub(_escaped, pattern)).fullmatch
        for name in names:
            if fits(name, timeout=max(end - time.process_time(), 1e-6)):
                found.add(name)
    except regex.error as error:
        raise BadPattern(f"the regular expression `/{pattern}/` is not valid: {error.msg}") from None
    except (TimeoutError, MemoryError, RecursionError):
        raise BadPattern(
            f"the regular expression `/{pattern}/` takes longer than {seconds:g} seconds",
            "write it without repetitions inside repetitions, or use a glob",
            is_slow=True,
        ) from None
    return frozenset(found)


def _escaped(found: re.Match[str]) -> str:
    return found[1] or f"\\{found[2]}"
