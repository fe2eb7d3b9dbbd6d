"""Pass: whose replicate is whose, while the units are apart; those that cannot stay are written out."""

from __future__ import annotations

from composer.link.linking import Linking


def replicates(linking: Linking) -> None:
    """Note every replicate, and write out those that would not mean in the model what they mean alone.

    Beside the clock of the base, MuJoCo would make two clocks with this replicate:

    >>> from composer.link.example import after
    >>> part = '<worldbody><replicate count="2"><geom name="g" size=".1"/></replicate></worldbody>'
    >>> base = '<sensor><clock/></sensor>'
    >>> after(replicates, part, base)
    part: <worldbody><frame><geom name="g0" size=".1"/></frame><frame><geom name="g1" size=".1"/></frame></worldbody>
    """
    if not linking.parts:
        return
    holding = [unit for unit in linking.units if next(unit.root.iter("replicate"), None) is not None]
    if not holding:
        return
    from composer.link.unrolling import unroll  # few models have any

    unroll(linking, holding)
    for unit in holding:
        linking.notes.replicates.extend((unit, replicate) for replicate in unit.root.iter("replicate"))
