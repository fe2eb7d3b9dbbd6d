"""Code action: accept an intended warning by adding its code to `allow`."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.diagnostic import Severity
from composer.lsp.actions.offer import Offer
from composer.lsp.answers import Action
from composer.lsp.writing import with_item
from composer.recipe.allow import ALLOW


def offer(offered: Offer) -> Iterator[Action]:
    """Yield, for each warning at the place, a change that adds its code to `allow`."""
    tree, analysis = offered.tree, offered.analysis
    for diagnostic in offered.diagnostics if tree is not None else ():
        if (
            diagnostic.severity is not Severity.ERROR
            and diagnostic.code != "unused-allow"
            and tree is not None
        ):
            change = with_item(tree, analysis.lines, analysis.file, ALLOW, diagnostic.code)
            if change is not None:
                yield Action(f"acknowledge this: `{ALLOW}: [{diagnostic.code}]`", (change,), diagnostic)
