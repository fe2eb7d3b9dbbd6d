"""What licence files are called."""

from __future__ import annotations

import os
import re

_NAME = re.compile(r"(licen[sc]e|copying|notice)s?([-_. ].*)?", re.IGNORECASE)
_NOT_TEXT = frozenset(
    {".py", ".pyc", ".pyi", ".js", ".json", ".xml", ".yaml", ".yml", ".toml", ".sh", ".h", ".png"}
)


def is_licence(name: str) -> bool:
    """Whether a file of that name is a licence or a notice. No I/O.

    >>> [name for name in ("LICENSE", "licence-mit.txt", "licenses.py", "NOTICED") if is_licence(name)]
    ['LICENSE', 'licence-mit.txt']
    """
    return _NAME.fullmatch(name) is not None and os.path.splitext(name)[1].lower() not in _NOT_TEXT


def licence_names(folder: str) -> str:
    """The names of the licences in a folder, a line for each. Raises OSError."""
    return "\n".join(sorted(name for name in os.listdir(folder) if is_licence(name)))
