"""The characters that XML cannot hold, so that no name, value or path in a model can."""

from __future__ import annotations

import re

NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def code_point(character: str) -> str:
    r"""Return a message's text for an unprintable character.

    >>> code_point("\x00")
    'U+0000'
    """
    return f"U+{ord(character):04X}"
