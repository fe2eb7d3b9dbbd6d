"""A diff by its effect: major changes break the interface, minor ones change the motion, patches only the looks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from difflib import SequenceMatcher

from mjcompose.base.diagnostic import Span
from mjcompose.language.recipe import KINDS, Order
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.index import Index
from mjcompose.sources.context import Context
from mjcompose.text.node import find, locate
from mjcompose.tools.diff.cause import Causes
from mjcompose.tools.diff.changes import LEVELS, Breaking, Cause, Change, Diff, Group, Level
from mjcompose.tools.diff.diff import grouped, worded
from mjcompose.tools.diff.models import looks
from mjcompose.tools.diff.sides import Side
from mjcompose.tools.names import names_of

_INTERFACE = frozenset(
    "jnt_type jnt_range jnt_limited actuator_ctrlrange actuator_ctrllimited actuator_actrange actuator_actlimited"
    " actuator_trntype actuator_trnid actuator_actnum actuator_ctrlnum actuator_dyntype sensor_type sensor_dim"
    " sensor_objtype sensor_objid sensor_reftype sensor_refid sensor_cutoff unit place".split()
)
"""The fields that determine the place and the meaning of a number in `qpos`, `ctrl`, `act` or `sensordata`."""
_LOOKS = frozenset({"material", "texture", "light", "skin", "visual"})
_LOOK_FIELDS = ("_rgba", "_matid", "_group", "extent", "center", "meansize")
_ROWS: Mapping[str, str] = {"key": "keyframes"}


def breaking(a: Side, b: Side, found: Diff, *, session: Session, context: Context) -> Breaking | None:
    """Return the changes of a diff by level, or None if MuJoCo crashes, which is reported. The session has both models.

    If a recipe has an `interface`, only the names that it lists count as major. The interface of A comes first.
    """
    read = [names_of(side, session, context) for side in (a, b)]
    answer = engine.call(session, looks, [a.kept, b.kept], argument=None)
    if not answer.ok:
        context.sink.error("mujoco-crash", f"the changes cannot be sorted: {answer.error or answer.crash}")
    if read[0] is None or read[1] is None or not answer.ok:
        return None
    contrast, listed = found.contrast, a.plan.interface if a.plan is not None else ()
    listed = listed or (b.plan.interface if b.plan is not None else ())
    sorting = _Sorting({each.kind: each for each in listed}, answer.value)
    renamed = {(each.kind, str(each.before)): each.name for each in contrast.changes if each.what == "renamed"}
    own = [*_units_and_places(read[0].index, read[1].index, renamed)]
    direct = [each for each in contrast.changes if not each.follows] or [*contrast.changes]
    causes = Causes(a, b, contrast)
    levels: list[Level] = []
    for name in LEVELS:
        changes = [each for each in (*direct, *own) if sorting.level(each) == name]
        placed = [each for each in changes if each.field == "place"]
        groups = [*_reordered(placed, causes, a, b=b)]
        groups += grouped([each for each in changes if each.field != "place"], causes, a, b=b)
        moves = tuple(each for each in contrast.moves if sorting.of_name(each.kind, each.name) == name)
        arrays = contrast.arrays if name == "minor" and not own else ()
        if groups or moves or arrays:
            levels.append(Level(name, tuple(groups), moves, arrays=arrays))
    return Breaking(found, tuple(levels))


class _Sorting:
    """Sorts changes into levels. `orders` has the interface by kind, `looks` the elements of both sides by kind."""

    def __init__(self, orders: Mapping[str, Order], looks: Sequence[Mapping[str, list[int]]]) -> None:
        self.orders, self.looks = orders, looks

    def of_name(self, kind: str, *names: str) -> str:
        """Return the level of a change in the names, places or meaning of an element."""
        if kind not in KINDS:
            return "minor"
        order = self.orders.get(kind)
        listed = not self.orders or (order is not None and (not order.more or not {*names}.isdisjoint(order.names)))
        return "major" if listed else "minor"

    def level(self, change: Change) -> str:
        kind = change.kind.partition("/")[0]
        field = change.field.partition("[")[0]
        if kind in KINDS and (change.what != "changed" or field in _INTERFACE):
            return self.of_name(kind, change.name, change.name_before)
        if kind in _LOOKS or field.endswith(_LOOK_FIELDS):
            return "patch"
        ids = [(side.get(kind, ()), at) for side, at in zip(self.looks, change.index, strict=True) if at >= 0]
        only_seen = ids and all(at in seen for seen, at in ids)
        return "patch" if only_seen else "minor"


def _units_and_places(a: Index, b: Index, renamed: Mapping[tuple[str, str], str]) -> Iterator[Change]:
    """Yield changes that no array of `mjModel` has: units of controls and sensors, and the order of elements."""
    for kind in KINDS:
        before, after = (getattr(each, _ROWS.get(kind, f"{kind}s")) for each in (a, b))
        places = {each.name: at for at, each in enumerate(after) if each.name}
        pairs = [(at, places[name]) for at, each in enumerate(before)
                 if (name := renamed.get((kind, each.name), each.name)) in places]  # fmt: skip
        order = [place for _, place in pairs]
        blocks = SequenceMatcher(None, order, sorted(order), autojunk=False).get_matching_blocks()
        kept = {place for block in blocks for place in order[block.a : block.a + block.size]}
        for at, place in pairs:
            one, other = before[at], after[place]
            change = Change("changed", kind, other.name, index=(at, place), name_before=one.name)
            units = [getattr(each, "unit", None) for each in (one, other)]
            if units[0] != units[1]:
                yield replace(change, field="unit", before=units[0], after=units[1])
            if place not in kept:
                yield replace(change, field="place", before=at, after=place)


def _reordered(changes: Sequence[Change], causes: Causes, a: Side, b: Side) -> Iterator[Group]:
    """Yield elements in another order, by kind, with the list in `interface` or the first of their lines."""
    for kind in dict.fromkeys(each.kind for each in changes):
        alike = tuple(each for each in changes if each.kind == kind)
        spans = [_listed(side, kind) for side in (a, b)]
        if not any(spans):
            ends = (causes.a, alike[0].name_before), (causes.b, alike[0].name)
            nodes = [None if side is None else side.node(kind, name, -1) for side, name in ends]
            spans = [causes.places.span(side, node, None) for side, node in enumerate(nodes)]
        cause = Cause(f"the order of {kind}s", spans[0], spans[1]) if any(spans) else None
        yield Group(worded(cause, a, b), alike)


def _listed(side: Side, kind: str) -> Span | None:
    if side.plan is None or find(side.plan.document, ("interface", kind)) is None:
        return None
    return locate(side.plan.document, ("interface", kind), key=True)
