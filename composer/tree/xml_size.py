"""Limit the cost of an XML file by its bytes, because its tree takes fifty times as much memory."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.limits import advice, in_force
from composer.tree.line import line_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

_COMMENT = re.compile(rb"<!--.*?-->", re.DOTALL)
_STRETCH = re.compile(rb"<!--.*?-->|[^<>\"]+", re.DOTALL)
"""Text that may be long: a comment, or anything between the delimiters of XML."""
_COLUMNS = 10_000


def check_text(data: bytes, file: str, sink: Sink) -> bool:
    """Return whether XML may be parsed: it has not too many elements and no text that is too long. Report it if not."""
    limits = in_force()
    tags = _tags(data) if len(data) > limits.elements else 0
    if tags > limits.elements:
        tags -= sum(_tags(found.group()[1:]) for found in _COMMENT.finditer(data))
    if tags > limits.elements:
        message = f"`{file}` has {tags} elements; {limits.elements} are allowed"
        sink.error("limit-exceeded", message, Span(file, 1, 1), help=advice("elements", tags))
        return False
    return len(data) <= limits.text_size or _check_stretches(data, file, sink)


def check_attributes(root: Node, data: bytes, file: str, sink: Sink) -> bool:
    """Return whether no element read from `data` has too many attributes, because each may be a fault.

    Report the first one that has.
    """
    most = in_force().attributes
    if not _has_long_tag(data, most * len('a=""')):
        return True
    found: Any = root.xpath(f"(descendant-or-self::*[count(@*) > {most}])[1]")
    if not found:
        return True
    (node,) = found
    message = f"`<{node.tag}>` has {len(node.attrib)} attributes; {most} are allowed"
    sink.error(
        "limit-exceeded",
        message,
        Span(file, line_of(node) or 1, 1),
        help=advice("attributes", len(node.attrib)),
    )
    return False


def _has_long_tag(data: bytes, length: int) -> bool:
    """Return whether so many bytes follow one another without a `<`, which in a tag only occurs at its start.

    >>> _has_long_tag(b"<a><b/></a>", 4), _has_long_tag(b"<a><b/></a>", 3)
    (False, True)
    """
    at = data.find(b"<")
    while 0 <= at < len(data) - length:
        following = data.rfind(b"<", at + 1, at + 1 + length)
        if following < 0:
            return True
        at = following
    return False


def _tags(data: bytes) -> int:
    return data.count(b"<") - data.count(b"</") - data.count(b"<!") - data.count(b"<?")


def _check_stretches(data: bytes, file: str, sink: Sink) -> bool:
    limit = in_force().text_size
    longest = max(_STRETCH.finditer(data), key=lambda found: found.end() - found.start(), default=None)
    if longest is None or longest.end() - longest.start() <= limit:
        return True
    at, size = longest.start(), longest.end() - longest.start()
    line, begin = data.count(b"\n", 0, at) + 1, data.rfind(b"\n", 0, at) + 1
    column = len(data[begin:at].decode("utf-8", "replace")) + 1 if at - begin < _COLUMNS else 1
    message = f"an attribute, comment or text has {size} bytes; {limit} are allowed"
    sink.error("limit-exceeded", message, Span(file, line, column), help=advice("text-size", size))
    return False
