"""Format a recipe's text in its canonical layout."""

from __future__ import annotations

import re

from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.decode import decode
from composer.document.load import load
from composer.document.node import Node
from composer.document.tokens import comments, tokens
from composer.formatting.order import put_in_order
from composer.formatting.read import Unusual, read
from composer.formatting.same import difference
from composer.formatting.write import write

_LINE_BREAK = re.compile(r"\r\n|\n")


def format_recipe(source: bytes, file: str, sink: Sink) -> bytes | None:
    """Return the text in its canonical layout, or None if it is not YAML or its meaning would change.

    Comments, blank lines between entries, anchors, the choice between lines and brackets, a byte order mark and the
    line breaks (those of the first line) are kept. The result is parsed again and compared: values, the order of
    keys if it has a meaning, comments. No I/O.
    """
    before = sink.error_count
    node = load(source, file, sink)
    if node is None or sink.error_count > before:
        return None
    text = decode(source, file, sink)
    assert text is not None
    try:
        document = read(text)
    except Unusual as unusual:
        sink.error(
            "cannot-format",
            f"`{file}` is left as it is: {unusual}",
            Span(file, unusual.line, 1),
            help="write it in the usual form",
        )
        return None
    put_in_order(document.root)
    first = _LINE_BREAK.search(text)
    end = first.group() if first else "\n"
    result = end.join([*write(document), ""])
    changed = _changed(node, text, result, file=file)
    if changed is not None:
        sink.error(
            "cannot-format",
            f"`{file}` is left as it is: in the canonical layout it would not say the same",
            Span(file, 1, 1),
            notes=(Note(changed),),
            help="please report it: this is a fault of `mjcompose fmt`, not of the recipe",
        )
        return None
    mark = "\ufeff" if source.startswith(b"\xef\xbb\xbf") else ""
    return (mark + result).encode("utf-8")


def _changed(node: Node, text: str, result: str, file: str) -> str | None:
    """Return what changed, or None if nothing did."""
    again = load(result, file, Sink())
    if again is None:
        return "it could not be read again"
    found = difference(node, again)
    if found is not None:
        return f"`{found}` would be another value" if found else "it would be another value"
    if sorted(comments(tokens(text))) != sorted(comments(tokens(result))):
        return "a comment would be lost"
    return None
