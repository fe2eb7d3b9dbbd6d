"""Hide secrets in addresses, so that they appear in no message, lock or bundle."""

from __future__ import annotations

import re
from collections.abc import Callable

_LOGIN = re.compile(r"(?<=://)([^/\s@:]*:|(?=gh[opsur]_|github_pat_|glpat-))([^/\s@]+)(?=@)")
_PARAMETER = re.compile(r"""([?&;]([^=&;#?\s"'`]+)=)((?:(?!@sha256:)[^&;#\s"'`])+)""")
_NAME = re.compile(
    r".*(token|secret|password|passwd|passphrase|signature|(api|access|private)[-_]?key|credentials?|authorization)"
    r"|(.*[-_])?(sig|pwd|pass|auth|jwt)",
    re.IGNORECASE,
)


def hide(text: str, shown: Callable[[str], str] = lambda secret: "…") -> str:
    """Return a text with each secret of an address replaced by `shown` of it. No I/O.

    >>> hide("https://me:1234@host/a.zip?raw=1&Access_Token=5678#x.xml")
    'https://me:…@host/a.zip?raw=1&Access_Token=…#x.xml'
    """

    def parameter(found: re.Match[str]) -> str:
        from urllib.parse import unquote  # few texts have a query

        is_secret = _NAME.fullmatch(unquote(found[2]))
        return found[1] + shown(found[3]) if is_secret else found[0]

    if "=" in text:
        text = _PARAMETER.sub(parameter, text)
    return _LOGIN.sub(lambda found: found[1] + shown(found[2]), text) if "://" in text else text


def masked(line: str) -> str:
    """Return a source line with secrets as asterisks, so that its length stays the same. No I/O."""
    return hide(line, lambda secret: "*" * len(secret))
