"""Hover for a selector: the elements that it matches."""

from __future__ import annotations

from composer.lsp.answers import Hover
from composer.lsp.matches import label, matches, selector_around
from composer.lsp.question import Question

_MOST = 20


def show(question: Question) -> Hover | None:
    """Return the elements that the selector around the cursor matches, or None."""
    around = selector_around(question)
    found = None if around is None else matches(*around, question.analysis)
    if around is None or found is None:
        return None
    where = ", of which `where` may take some away" if "where" in around[1] else ""
    lines = [f"**matches {len(found)} element{'s' * (len(found) != 1)}** of the finished model{where}", ""]
    lines += [f"- {label(node)}" for node in found[:_MOST]]
    if len(found) > _MOST:
        lines.append(f"- … and {len(found) - _MOST} more")
    return Hover("\n".join(lines), question.word)
