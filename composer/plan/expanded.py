"""Write a concrete recipe as text: variants, parameters and expressions resolved, with the origin of each value."""

from __future__ import annotations

import json
from collections.abc import Iterator

from composer.diagnostics.span import Span
from composer.document.node import Mapping, Node, Scalar
from composer.document.node import Sequence as List
from composer.document.scalar import resolve
from composer.grammar.format import number_text
from composer.plan.plan import Plan

_COLUMN = 60


def expanded_text(plan: Plan) -> str:
    """Return YAML, each line with the file and line of its value as a comment."""
    read = [
        f"# in {file}: angle: {each.angle or 'none'}, eulerseq: {each.eulerseq}"
        for file, each in plan.angle_context.others.items()
    ]
    written = [f"{text:<{_COLUMN}}  # {span.file}:{span.line}" for text, span in _lines(plan.document, "")]
    return "\n".join([*read, *written])


def _lines(node: Mapping, indent: str) -> Iterator[tuple[str, Span]]:
    for name, (key, value) in node.entries.items():
        yield from _entry(f"{indent}{_text(name)}:", value, indent + "  ", span=key.span)


def _entry(start: str, value: Node, indent: str, span: Span) -> Iterator[tuple[str, Span]]:
    if isinstance(value, Scalar) or _is_short(value):
        yield f"{start} {_flow(value)}", value.span
    elif isinstance(value, Mapping):
        yield start, span
        yield from _lines(value, indent)
    else:
        yield start, span
        for item in value.items:
            if isinstance(item, Mapping) and not _is_short(item):
                inner = list(_lines(item, indent + "  "))
                (first, place), *rest = inner
                yield f"{indent}- {first.lstrip()}", place
                yield from rest
            else:
                yield f"{indent}- {_flow(item)}", item.span


def _is_short(node: Node) -> bool:
    """Return whether a node contains only values from one line of one file."""
    if isinstance(node, Scalar):
        return True
    inside = list(node.items) if isinstance(node, List) else [value for _, value in node.entries.values()]
    places = {(each.span.file, each.span.line) for each in inside}
    return len(places) <= 1 and all(isinstance(each, Scalar) or _is_short(each) for each in inside)


def _flow(node: Node) -> str:
    if isinstance(node, Scalar):
        return _value(node)
    if isinstance(node, List):
        return f"[{', '.join(_flow(item) for item in node.items)}]"
    return (
        "{" + ", ".join(f"{_text(name)}: {_flow(value)}" for name, (_, value) in node.entries.items()) + "}"
    )


def _value(node: Scalar) -> str:
    if isinstance(node.value, str):
        return _text(node.value)
    if node.value is None or isinstance(node.value, bool):
        return "null" if node.value is None else str(node.value).lower()
    return number_text(node.value)


def _text(text: str) -> str:
    """Return text in YAML, quoted only if necessary."""
    plain = (
        text
        and text == text.strip()
        and not set(text) & set("{}[],&*#?|<>=!%@`\"'\n\t\\")
        and text[0] not in "-:"
    )
    if plain and ": " not in text and not text.endswith(":") and isinstance(resolve(text), str):
        return text
    return json.dumps(text, ensure_ascii=False)
