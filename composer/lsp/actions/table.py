"""All kinds of code actions, one row for each."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from composer.lsp.actions import acknowledge, attach, fixes, near, settle, units
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action

OFFERS: tuple[Callable[[Offer], Iterator[Action]], ...] = (
    fixes.offer,
    near.offer,
    settle.offer,
    attach.offer,
    units.offer,
    acknowledge.offer,
)


def actions(offered: Offer) -> list[Action]:
    """Return the changes that are offered at a place. The fixes of diagnostics come first."""
    found: dict[tuple[str, object], Action] = {}
    for offer in OFFERS:
        for action in offer(offered):
            found.setdefault((action.title, action.changes), action)
    return list(found.values())
