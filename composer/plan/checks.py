"""Checks in words."""

from __future__ import annotations

from collections.abc import Iterator

from composer.document.node import Mapping, Node, Scalar
from composer.plan.plan import Plan


def checks_of(plan: Plan) -> Iterator[str]:
    """What will be checked of the model, a line for each."""
    for check in plan.checks:
        node: Node = plan.document
        for key in (*check.at, check.word):
            assert isinstance(node, Mapping)
            node = node.entries[str(key)][1]
        yield f"check {check.name}: {check.word} {_flow(node)}"


def _flow(node: Node) -> str:
    if isinstance(node, Scalar):
        return node.text
    if isinstance(node, Mapping):
        return f"{{{', '.join(f'{name}: {_flow(value)}' for name, (_, value) in node.entries.items())}}}"
    return f"[{', '.join(map(_flow, node.items))}]"
