"""Find which elements of a part are unchanged in the merged model, as MuJoCo compiles them.

A merged model may write the same thing differently: in radians, with six digits, with `pos` and `quat` for
`fromto`, with a class in place of an attribute. Comparing compiled models limits edits to differences in meaning.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, Any

from composer.compiled.correspondence import Correspondence
from composer.compiled.kinds import KINDS, Model, NameTable
from composer.compiled.mount import Mount
from composer.compiled.quantities import follows
from composer.dataclass import dataclass
from composer.diff.change import Change, Value
from composer.diff.models import references
from composer.diff.values import Values
from composer.explain.query import ordered
from composer.tree.kinds import kind_of
from composer.tree.kinds import query as paths_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.tree.unit import Unit

ROUNDING = 1e-5
"""MuJoCo writes six digits when it saves a model: numbers that differ by less are the same."""

_SMALLEST = 1e-6  # smaller numbers are compared as if they had this size
_MASSES = frozenset({"body_mass", "body_inertia", "body_ipos", "body_iquat"})
_KINDS = {path: kind for kind in KINDS if kind != "plugin" for path in paths_of(kind, None).paths}


@dataclass(frozen=True, slots=True)
class Likeness:
    """By kind, the pairs of elements of the part and the merged model that are the same except for rounding.

    Elements are numbered as in MuJoCo; `counts` has, by kind, how many the two models have.
    """

    same: Mapping[str, frozenset[tuple[int, int]]] = field(default_factory=dict)
    counts: Mapping[str, tuple[int, int]] = field(default_factory=dict)


def unchanged(mujoco: Any, alone: Model, merged: Model, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return a `Likeness` as JSON data; runs under `composer.engine.call`.

    ``given`` has the ``prefix`` of the part's names in the merged model, ``names`` for those that are not just
    prefixed, and the ``body`` that the part is attached to.
    """
    matching = Correspondence(
        NameTable(alone),
        NameTable(merged),
        prefix=given["prefix"],
        mount=Mount(given["body"], None),
        renamed=given["names"],
        by_order=False,
    )
    changed: dict[str, set[tuple[int, int]]] = defaultdict(set)
    for each in (*references(matching), *Values(mujoco, matching, 0.0).changes()):
        if not follows(each.field) and not is_rounding(each):
            changed[each.kind].add(each.index)
            if each.field in _MASSES:
                changed["mass"].add(each.index)
    same = {
        kind: [pair for pair in matching.pairs(kind) if pair not in changed[kind]]
        for kind in KINDS
        if kind != "key"
    }
    heavier = {after for _, after in changed["mass"]}  # its own numbers do not say which geom causes that
    same["geom"] = [pair for pair in same["geom"] if int(merged.geom_bodyid[pair[1]]) not in heavier]
    counts = {
        kind: [len(getattr(model, KINDS[kind].addresses)) for model in (alone, merged)] for kind in KINDS
    }
    return {"same": same, "counts": counts}


def likeness_of(data: Mapping[str, Any]) -> Likeness:
    """Return the likeness from its JSON data."""
    return Likeness(
        {kind: frozenset((i, j) for i, j in pairs) for kind, pairs in data["same"].items()},
        {kind: (a, b) for kind, (a, b) in data["counts"].items()},
    )


def is_rounding(change: Change) -> bool:
    """Return whether the numbers are the same to six digits; quaternions may have the opposite sign."""
    ours, theirs = numbers(change.before), numbers(change.after)
    if ours is None or theirs is None or len(ours) != len(theirs):
        return False
    return near(ours, theirs) or (change.field.endswith("quat") and near(ours, [-each for each in theirs]))


def near(ours: list[float], theirs: list[float]) -> bool:
    size = max([_SMALLEST, *map(abs, ours), *map(abs, theirs)])
    return all(abs(a - b) <= ROUNDING * size for a, b in zip(ours, theirs, strict=True))


def numbers(value: Value) -> list[float] | None:
    """Return the numbers of a value as a flat list, or None if it contains anything else."""
    if isinstance(value, float) or (isinstance(value, int) and not isinstance(value, bool)):
        return [value]
    if not isinstance(value, tuple):
        return None
    inner = [numbers(each) for each in value]
    return None if None in inner else [number for each in inner for number in each or ()]


def places(unit: Unit) -> dict[Node, tuple[str, int]]:
    """Return kind and number of every element in MuJoCo's order, unless one element of the file makes several."""
    found: dict[Node, tuple[str, int]] = {}
    count: dict[str, int] = defaultdict(int)
    for node in ordered(unit.root):
        kind = "body" if node.tag == "worldbody" else _KINDS.get(kind_of(node).path)
        if kind is None or (node.tag == "worldbody" and count["body"]):
            continue
        found[node] = (kind, count[kind])
        count[kind] += 1
    return found
