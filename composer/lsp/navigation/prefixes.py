"""Names and patterns when the key of a part, and so its prefix, changes."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase

_CHOICE = re.compile(r"\{([^{}]*)\}")


class NotSure(Exception):
    """Raised for a pattern that would match other names under the new key, and that cannot be rewritten."""


def renamed(text: str, old: str, new: str, separator: str, pattern: bool) -> str | None:
    """Return a name or pattern with the new prefix, or None if it stays as it is.

    `old` and `new` have no separator at the end. Raises NotSure.

    >>> renamed("left/tip", "left", "arm", "/", False), renamed("{left,right}/*", "left", "arm", "/", True)
    ('arm/tip', '{arm,right}/*')
    """
    if not pattern:
        return new + text[len(old) :] if text == old or text.startswith(old + separator) else None
    if text.startswith("/") and text.endswith("/") and len(text) > 1:
        if re.search(rf"(?<!\w){re.escape(old)}(?!\w)", text):
            raise NotSure(text)
        return None
    before, after = old.split(separator), new.split(separator)
    steps = text.split(separator)
    for at, (was, now) in enumerate(zip(before, after, strict=True)):
        if at >= len(steps) or steps[at] == "**":
            break
        step = steps[at]
        if step == was:
            steps[at] = now
        elif "{" in step and not _fits(step, was):
            return None
        elif "{" in step:
            steps[at] = _CHOICE.sub(lambda found, was=was, now=now: _choice(found[1], was, now), step)  # type: ignore[misc]
            if not _fits(steps[at], now):
                raise NotSure(text)
        elif _fits(step, was) != _fits(step, now):
            raise NotSure(text)
        elif not _fits(step, was):
            return None
    result = separator.join(steps)
    return None if result == text else result


def _choice(options: str, was: str, now: str) -> str:
    return "{" + ",".join(now if each == was else each for each in options.split(",")) + "}"


def _fits(step: str, name: str) -> bool:
    """Return whether one step of a glob matches a name."""
    found = _CHOICE.search(step)
    if found is None:
        return fnmatchcase(name, step.replace("[", "[[]"))
    head, tail = step[: found.start()], step[found.end() :]
    return any(_fits(head + option + tail, name) for option in found[1].split(","))
