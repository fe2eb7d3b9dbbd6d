"""Refuse XML that MuJoCo parses differently from an XML parser, so that both see the same model.

MuJoCo 4.0 reads bytes as UTF-8 whatever the declaration says, and ends a `<!DOCTYPE` at the first `>`: a comment in
a DTD can be a model for MuJoCo.
"""

from __future__ import annotations

import re

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span

_DECLARED = re.compile(rb"""\A(?:\xef\xbb\xbf)?\s*<\?xml\b[^>]*?\bencoding\s*=\s*["']([^"']*)["']""")
_ASCII = re.compile(r"utf-?8|(us-)?ascii|iso-?8859-?\d+|latin-?\d|windows-125\d|cp125\d", re.IGNORECASE)
"""Encodings with the same bytes as ASCII for tags."""
_WIDE = (b"\xff\xfe", b"\xfe\xff", b"\x00\x00\xfe\xff", b"<\x00", b"\x00<")
_PLAIN = re.compile(rb"<!DOCTYPE\s+[\w:.-]+\s*>")
"""A doctype that ends at its first `>`, and neither declares anything nor names another file."""


def refused(data: bytes, file: str, sink: Sink) -> bool:
    """Return whether the text is refused, which is reported.

    >>> refused(b'<!DOCTYPE mujoco [<!-- > <mujoco model="other"/> -->]><mujoco/>', "a.xml", Sink())
    True
    """
    declared = _DECLARED.match(data)
    named = declared[1].decode("ascii", "replace") if declared is not None else "UTF-8"
    if data.startswith(_WIDE):
        named = "UTF-16"
    if not _ASCII.fullmatch(named):
        message = f"`{file}` is in the encoding `{named}`, and MuJoCo reads UTF-8 alone"
        sink.error("xml-syntax", message, Span(file, 1, 1), help="save it as UTF-8")
        return True
    at = data.find(b"<!DOCTYPE")
    while at >= 0 and _PLAIN.match(data, at):
        at = data.find(b"<!DOCTYPE", at + 1)
    if at < 0:
        return False
    before = data[:at]
    line = before.count(b"\n") + 1
    column = len(before[before.rfind(b"\n") + 1 :].decode("utf-8", "replace")) + 1
    message = f"`{file}` has a DTD, which MuJoCo does not read"
    sink.error("xml-syntax", message, Span(file, line, column), help="take the `<!DOCTYPE …>` out")
    return True
