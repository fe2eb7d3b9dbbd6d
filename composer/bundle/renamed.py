"""Names of parts that are no longer their own names with a prefix."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from composer.plan.part_record import PartRecord
from composer.tree.kinds import kind_of, naming_attribute
from composer.tree.unit import Unit

Renamed = Mapping[str, Mapping[str, Mapping[str, str]]]
"""By part and kind of name: own names mapped to names in the model."""


def renamed_in(model: Unit, members: Iterable[PartRecord]) -> Renamed:
    """Return what edits renamed, traced back through later prefixes; elements removed since are left out."""
    by_prefix = {member.prefix: member.part for member in reversed(list(members))}
    found: dict[str, dict[str, dict[str, str]]] = {}
    for node, steps in model.origins.renamed.items():
        naming = naming_attribute(kind_of(node)) if node.getroottree().getroot() is model.root else None
        final = None if naming is None else node.get(naming.name)
        if naming is None or naming.declares is None or not final:
            continue
        name = str(final)
        for old, new in reversed(steps):
            name = name.removesuffix(new) + old
        prefix = max((each for each in by_prefix if name.startswith(each)), key=len, default=None)
        if prefix is not None and name != final:
            names = found.setdefault(by_prefix[prefix], {}).setdefault(naming.declares, {})
            names[name[len(prefix) :]] = str(final)
    return {
        part: {kind: dict(sorted(names.items())) for kind, names in sorted(kinds.items())}
        for part, kinds in found.items()
    }
