"""The characters that XML cannot hold, and so no name, no value and no path in a model."""

from __future__ import annotations

import re

NOT_XML = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def code_point(character: str) -> str:
    r"""How a message shows a character that cannot be printed.

    >>> code_point("\x00")
    'U+0000'
    """
    return f"U+{ord(character):04X}"
