"""Make one model of all cells: those of one tree are joined, and different trees become parts of a union."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from mjcompose.bundle.bundle import Bundle
from mjcompose.tools.worlds.join import Joining, WorldGroup
from mjcompose.tools.worlds.one_tree import JointPlace, join_cells
from mjcompose.tools.worlds.same_tree import is_same_tree
from mjcompose.tools.worlds.worlds import Worlds


def combine(joining: Joining, place: JointPlace) -> tuple[Worlds, Bundle | None]:
    """Return all models as worlds, and the bundle of their common model if it is none of theirs. Raises LoadError."""
    if len(joining.groups) == 1:
        return joining.worlds(), None
    trees = _trees(joining.groups)
    if len(trees) == 1:
        joint = join_cells(joining.groups, place)
        study = joining.with_groups([joint.group]).worlds()
        present = joining.presence(joint.present)
        return replace(study, table=replace(study.table, present=present)), joint.bundle
    from mjcompose.tools.worlds.union import unite

    groups = []
    for number, alike in enumerate(trees):
        name = f"{place.name}-{number + 1}"
        whole = len(alike) == 1
        groups.append(alike[0] if whole else join_cells(alike, replace(place, name=name), fixed_assets=True).group)
    name = f"{place.name}-union"
    return unite(joining.with_groups(groups), name, place.context, session=place.session)


def _trees(groups: Sequence[WorldGroup]) -> list[list[WorldGroup]]:
    """Return the groups with one tree together."""
    trees: list[list[WorldGroup]] = []
    for group in groups:
        model = group.first.loaded.model
        known = next((alike for alike in trees if is_same_tree(alike[0].first.loaded.model, model)), None)
        if known is None:
            trees.append([group])
        else:
            known.append(group)
    return trees
