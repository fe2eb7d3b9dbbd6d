"""Pass: whose replicate is whose, while the units are apart; those that cannot stay are written out."""

from __future__ import annotations

from composer.link.linking import Linking


def replicates(linking: Linking) -> None:
    """Note every replicate, and write out those that would not mean in the model what they mean alone."""
    if not linking.parts:
        return
    holding = [unit for unit in linking.units if next(unit.root.iter("replicate"), None) is not None]
    if not holding:
        return
    from composer.link.unrolling import unroll  # few models have any

    unroll(linking, holding)
    for unit in holding:
        linking.notes.replicates.extend((unit, replicate) for replicate in unit.root.iter("replicate"))
