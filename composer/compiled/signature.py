"""Features that identify an unnamed element if its order does not."""

from __future__ import annotations

from collections.abc import Hashable

from composer.compiled.kinds import KINDS, Model
from composer.compiled.links import UNORDERED, Link, World, links
from composer.compiled.ragged import runs
from composer.compiled.rows import row_key


def distinguishes(link: Link) -> bool:
    """Return whether a reference helps to identify an element: not its place, nor elements that are matched later."""
    return link.kind != "plugin" and link.world is World.WORLD and link.field != "jnt_actuatorid"


def raw(model: Model, kind: str, index: int) -> Hashable:
    """Return the references of an element of the composition, comparable with the translated ones of the part."""
    targets = [(link.kind, link.index) for link in links(model, kind, index) if distinguishes(link)]
    return tuple(sorted(targets)) if kind in UNORDERED else tuple(targets)


def values(model: Model, kind: str, index: int) -> Hashable:
    """Return all values of an element, without its place and references."""
    data = tuple((name, array.tobytes()) for name, array in runs(model, kind, index) if kind != "flex")
    return row_key(model, kind, index), data


def shape(model: Model, kind: str, index: int) -> Hashable:
    """Return what rarely changes of an element: its type; for a body, its joints and the number of its geoms."""
    if kind == "body":
        first, number = int(model.body_jntadr[index]), int(model.body_jntnum[index])
        types = tuple(model.jnt_type[first : first + number].tolist()) if number else ()
        return types, int(model.body_geomnum[index])
    types_of = getattr(model, f"{KINDS[kind].arrays}_type", None)
    return None if types_of is None else int(types_of[index])
