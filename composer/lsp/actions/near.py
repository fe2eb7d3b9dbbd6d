"""A word that does not exist, where it is not clear which one was meant: the nearest of those that fit there."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.suggest import closest
from composer.document.quote import quoted, word
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action, Change
from composer.lsp.completion.table import complete

_MOST = 3


def offer(offered: Offer) -> Iterator[Action]:
    """The words that are offered at the place of an unknown one, as far as they are like it."""
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
