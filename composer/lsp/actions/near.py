"""Code action: replace an unknown word by a similar one that fits there, where several are possible."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.suggest import closest
from composer.document.quote import quoted, word
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action, Change
from composer.lsp.completion.table import complete

_MOST = 3


def offer(offered: Offer) -> Iterator[Action]:
    """Yield a change for each word that fits at the place and resembles the unknown one."""
    question = offered.question
    cursor = question.cursor
    written = cursor.whole.strip()
    about = next(
        (each for each in offered.diagnostics if each.fix is None and written in _about(each.subjects)), None
    )
    if about is None or not written:
        return
    labels = [item.label for item in complete(question).items if item.kind != "pattern"]
    for near in closest(written, [each for each in labels if each != written], _MOST):
        text = quoted(near)[1:-1] if cursor.quote else word(near)
        yield Action(f"write `{near}`", (Change(question.word, text),), about)


def _about(subjects: frozenset[str]) -> set[str]:
    return {each.strip() for each in subjects}
