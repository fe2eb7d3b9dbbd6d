"""Attributes with an index: `friction[0]` is the first number of `friction`."""

from __future__ import annotations

import re

_SUBSCRIPT = re.compile(r"([^\[\]]+)\[([0-9]{1,4})\]")


def attribute_and_index(name: str) -> tuple[str, int | None]:
    """Return the attribute that a key names, and the index of one of its numbers, or None for all of them.

    >>> attribute_and_index("friction[0]"), attribute_and_index("pos")
    (('friction', 0), ('pos', None))
    """
    found = _SUBSCRIPT.fullmatch(name)
    return (name, None) if found is None else (found[1], int(found[2]))
