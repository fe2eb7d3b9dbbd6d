"""Compare a part inside a composed model numerically with the part alone."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from composer.compiled.correspondence import Correspondence
from composer.compiled.coupling import Coupling
from composer.compiled.difference import Difference
from composer.compiled.keyframes import Keys, Roots, key_differences
from composer.compiled.kinds import Model, NameTable
from composer.compiled.mount import Mount
from composer.compiled.placing import Placing
from composer.compiled.presence import presence_differences
from composer.compiled.references import reference_differences
from composer.compiled.values import Values

__all__ = ["Difference", "Keys", "Mount", "Roots", "compare"]


def compare(
    alone: Model,
    composed: Model,
    *,
    prefix: str = "",
    hung_on: Mount | None = None,
    renamed: Mapping[str, Mapping[str, str]] | None = None,
    keys: Keys = Keys.MERGE,
    roots_in_keys: Roots = Roots.MOVED,
    others: Sequence[tuple[str, Model]] | None = None,
    ignore: Collection[str] = (),
    replaced_keys: Collection[str] = (),
    tolerance: float = 0.0,
    cut: bool = False,
) -> list[Difference]:
    """Return the differences between a part compiled alone and the same part in a composition.

    The result is empty if the part is unchanged. ``prefix`` includes its separator; the base's is empty.
    ``hung_on`` is the place of the part's world: the unmoved world by default. ``renamed`` maps names of the part
    to names in the composition, by kind, if they are not simply prefixed. ``ignore`` are arrays (`geom_friction`),
    or attributes of every kind (`friction`), that were changed on purpose; ``replaced_keys`` are keys of the
    composition that were written in place of the part's own. With ``others``, the prefixes and models of all other
    parts, elements with this part's prefix that belong to no part count as differences too.

    ``tolerance`` is relative to the larger of 1 and the value. 0 requires equality bit for bit wherever composition
    can preserve it; ``fields.RULES`` says where it cannot, and why. ``cut`` says that ``composed`` is the whole
    that the part was cut out of.

    Options, statistics and visual settings belong to the whole model and are not compared here. No I/O. Raises
    KeyError if ``hung_on`` names an unknown body.
    """
    mount = hung_on or Mount()
    matching = Correspondence(
        NameTable(alone), NameTable(composed), prefix=prefix, mount=mount, renamed=renamed or {}, cut=cut
    )
    coupling = Coupling(matching, mount, cut=cut)
    placing = Placing(matching, mount)
    found = presence_differences(matching, others)
    found += reference_differences(matching)
    found += Values(matching, coupling, placing, tolerance=tolerance).differences()
    if not coupling.in_place:
        found += placing.differences(tolerance)
    in_world = placing.transform if matching.mount == 0 else None
    found += key_differences(
        matching, in_world, keys, roots=roots_in_keys, tolerance=tolerance, replaced=replaced_keys
    )
    return [difference for difference in found if not _ignored(difference, ignore)]


def _ignored(difference: Difference, ignore: Collection[str]) -> bool:
    """Return whether ``ignore`` holds the array of the difference, or its name without the first word."""
    array = difference.array
    return array in ignore or array.partition("_")[2] in ignore
