"""Check values of parameters for a model that may have none."""

from __future__ import annotations

from composer.diff.operand import Kind, Operand
from composer.plan.concrete import Given


def check_given(operand: Operand, given: Given) -> bool:
    """Return whether the target accepts values; report that a model has no parameters."""
    if operand.kind is Kind.RECIPE:
        return True
    for name, node in given.items():
        message = f"`{operand.label}` is not a recipe and has no parameter `{name}`"
        operand.context.sink.error("unknown-name", message, node.span)
    return not given
