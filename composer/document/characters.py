r"""Characters that YAML allows and models do not: escapes such as `"\0"` that no XML file can hold."""

from __future__ import annotations

from composer.diagnostics import Sink, Span
from composer.document.node import Mapping, Node, Sequence
from composer.grammar.characters import NOT_XML, code_point


def check_characters(node: Node, sink: Sink) -> None:
    """Report every key and value with a character that cannot occur in a name, a path or a value of a model."""
    waiting = [node]
    while waiting:
        node = waiting.pop()
        if isinstance(node, Mapping):
            for key, value in node.entries.values():
                if odd := NOT_XML.search(key.name):
                    _refuse(odd.group(), key.span, sink)
                waiting.append(value)
        elif isinstance(node, Sequence):
            waiting += node.items
        elif odd := NOT_XML.search(node.text):
            _refuse(odd.group(), node.span, sink)


def _refuse(character: str, span: Span, sink: Sink) -> None:
    sink.error(
        "yaml-syntax",
        f"an escape here is the character {code_point(character)}, which XML cannot hold",
        span,
        help="leave it out",
    )
