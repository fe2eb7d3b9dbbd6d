"""Describe the origin of numbers in a key."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from composer.diagnostics.span import Span
from composer.explain.explanation import Reason, RowExplained
from composer.explain.rows import NumberOrigin
from composer.explain.trace import Change

_NOBODY = {
    "reference": "the reference configuration",
    "zero": "0, as no key says it",
    "unknown": "not known",
}


def row_explained(
    label: str, numbers: str, origin: NumberOrigin, reason: Reason, written: str | None
) -> RowExplained:
    """Return the row; `reason` comes from `reason_of`, `written` is the text at its place."""
    on_the_way = [Reason("by `from`", span) for span in origin.taken]
    on_the_way += [Reason(f"moved with the part `{part}`", span) for part, span in origin.moved]
    if origin.lost is not None:
        on_the_way.append(Reason("an edit has made meaningless what is written there:", origin.lost.span))
    return RowExplained(
        label, numbers, origin.kind, reason=reason, written=written, on_the_way=tuple(on_the_way)
    )


def reason_of(origin: NumberOrigin, edited: Callable[[Change], Reason]) -> Reason:
    """Return what set the numbers, and where; `edited` describes an edit or a draw."""
    if origin.change is not None:
        return edited(origin.change)
    if origin.kind == "mujoco":
        return Reason("filled up by MuJoCo, as the row ends in the middle of a joint", origin.span)
    return Reason(_NOBODY.get(origin.kind, ""), origin.span)


def only_place(reasons: Iterable[Reason]) -> Span | None:
    """Return the only place where numbers are written, or None if there are several."""
    spans = {reason.span for reason in reasons if reason.words not in _NOBODY.values()}
    return spans.pop() if len(spans) == 1 else None
