"""Code action: write an angle in the other unit."""

from __future__ import annotations

import math
from collections.abc import Iterator

from composer.expr.angle import Angle
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action, Change

_OTHER = {"deg": "rad", "rad": "deg"}


def offer(offered: Offer) -> Iterator[Action]:
    """Yield `90deg` as radians and `1.57rad` as degrees; for a reported angle without a unit, both units."""
    question = offered.question
    written = question.cursor.whole.strip()
    for unit, other in _OTHER.items():
        if written.endswith(unit) and Angle.read(written) is not None:
            text = f"{converted(float(written.removesuffix(unit)), unit):.10g}{other}"
            yield Action(f"write it as `{text}`", (Change(question.word, text),), kind="refactor.rewrite")
    for diagnostic in offered.diagnostics:
        if diagnostic.code == "bare-angle" and _is_number(written):
            for unit in _OTHER:
                change = Change(question.word, f"{written}{unit}")
                yield Action(f"it is in {unit}: `{written}{unit}`", (change,), diagnostic)


def converted(value: float, unit: str) -> float:
    """Return an angle in the other unit.

    >>> converted(180, "deg") == math.pi
    True
    """
    return math.radians(value) if unit == "deg" else math.degrees(value)


def _is_number(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False
