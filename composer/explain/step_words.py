"""Describe what a step of the plan, or another function, did to an element, with the place that is the reason."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from composer.diagnostics.span import Span
from composer.document.node import find, locate
from composer.explain.explanation import Reason
from composer.explain.trace import Cause
from composer.link.link import row_of
from composer.plan.plan import DropElements, Plan
from composer.plan.steps.draw_values import DrawValues
from composer.plan.steps.edit_elements import EditElements
from composer.plan.steps.step import Step
from composer.recipe.shown import shown

if TYPE_CHECKING:
    from lxml.etree import _Element as Node


def of_step(cause: Cause, owner: object, attribute: str | None, node: Node | None = None) -> Reason:
    """Return what a cause did, and where; `owner` wrote the element or its attribute."""
    done = cause.done
    if isinstance(done, Plan):
        return _by_plan(done, attribute)
    span = owned(owner, attribute) or getattr(done, "span", None)
    if isinstance(done, EditElements | DropElements):
        written_by_it = span is not None and span.file == done.span.file
        return Reason(done.words, span if written_by_it else done.span)
    if isinstance(done, DrawValues):
        drawn = None if node is None else _drawn(cause, node, done.field.name)
        value = "" if drawn is None else f": {shown(drawn)} is drawn"
        return Reason(f"{done.reason}{value}", done.span)
    if isinstance(done, Step):
        return Reason(done.reason, span)
    return Reason(_summary(done), span if isinstance(span, Span) else None)


def owned(owner: object, attribute: str | None) -> Span | None:
    """Return the place of an element or of its attribute, if its owner knows it."""
    if isinstance(owner, Span):
        return owner
    if callable(owner):
        span = owner(attribute)
        return span if isinstance(span, Span) else None
    return None


def _drawn(cause: Cause, node: Node, field: str) -> object | None:
    """Return what a field drew for an element, or for the body whose mass the element determines."""
    if cause.linking is None:
        return None
    for each in (node, *node.iterancestors("body")):
        if field in (found := cause.linking.notes.drawn.get(each, {})):
            return found[field]
    return None


def _by_plan(plan: Plan, attribute: str | None) -> Reason:
    if attribute == "model":
        named = find(plan.document, ("name",)) is not None
        words = "`name` of the recipe" if named else "the name of the recipe's file"
        return Reason(words, locate(plan.document, ("name",)) if named else None)
    return Reason("the recipe leaves it out", locate(plan.document, ("base", "keyframes")))


def _summary(done: object) -> str:
    """Return the words in the row of a pass, or the first line of another function's docstring."""
    if (row := row_of(done)) is not None:
        return row.words
    module = inspect.getmodule(done)
    text = (inspect.getdoc(done) or getattr(module, "__doc__", None) or type(done).__name__).strip()
    return text.splitlines()[0].removeprefix("Pass: ").rstrip(".")
