"""Compare two models by name, with causes and pictures, and sort the changes by effect.

Major changes break the interface, minor ones change the motion, patches only the looks.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

from mjcompose.base.alignment import Alignment
from mjcompose.base.diagnostic import Span
from mjcompose.base.files import RECIPES
from mjcompose.base.scratch import scratch
from mjcompose.bundle.staging import staged_file
from mjcompose.contrast.changes import (
    LEVELS,
    Breaking,
    CausedChanges,
    CauseLines,
    Contrast,
    Diff,
    FieldChange,
    LevelChanges,
    View,
)
from mjcompose.contrast.models import contrast, contrast_of, looks
from mjcompose.language.recipe import KINDS, Order
from mjcompose.mujoco import engine
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.index import CompiledIndex
from mjcompose.mujoco.pictures import NEEDS_OPENGL, pictures
from mjcompose.plan.read import Given
from mjcompose.sides.names import names_of
from mjcompose.sides.operand import OperandKind, read_operand
from mjcompose.sides.side import Side, load
from mjcompose.sources.context import Context
from mjcompose.text.node import find, locate
from mjcompose.tools.diff.cause import CauseFinder
from mjcompose.tools.diff.recipe_lines import block, different, excerpt, is_yaml


def render_views(folder: Path, kept: tuple[str, str], context: Context, session: Session) -> tuple[View, ...]:
    """Write the pictures of two models that `session` keeps; if that fails, report the reason."""
    with scratch("pictures") as made:
        answer = engine.call(session, pictures, kept, argument=str(made))
        if not answer.ok:
            reason = answer.error or answer.crash
            context.sink.error("no-rendering", f"no pictures could be made: {reason}")
            return ()
        reason = session.no_opengl or answer.value.get("no OpenGL")
        if reason is not None:
            context.sink.error("no-rendering", f"no pictures can be made without OpenGL: {reason}", help=NEEDS_OPENGL)
            return ()
        views: list[View] = []
        used: set[str] = set()
        with context.sink:
            for number, each in enumerate(answer.value["views"]):
                first = re.sub(r"[^\w.-]+", "_", each["name"]).lstrip(".") or "camera"
                stems = (first if count == 1 else f"{first}_{count}" for count in itertools.count(1))
                stem = next(stem for stem in stems if stem.lower() not in used)
                used.add(stem.lower())
                places = [folder / f"{stem}-{side}.png" for side in ("before", "after")]
                for place, side in zip(places, "ab", strict=True):
                    with staged_file(context.folder / place, "--renders") as stage:
                        stage.write_bytes(Path(made, f"{number}-{side}.png").read_bytes())
                views.append(View(each["name"], str(places[0]), str(places[1]), differs=each["differs"]))
            return tuple(views)
        return ()


def grouped(changes: Iterable[FieldChange], causes: CauseFinder, a: Side, b: Side) -> list[CausedChanges]:
    """Return one group for each line, ordered by file and line; changes without a known line come last."""
    found: dict[tuple[object, ...], tuple[CauseLines | None, list[FieldChange]]] = {}
    for change in changes:
        cause = causes.of(change)
        known, several = found.setdefault(_key(cause), (cause, []))
        several.append(change)
        if known is not None and known.before is None and cause is not None and cause.before is not None:
            found[_key(cause)] = cause, several
    return sorted([CausedChanges(worded(cause, a, b), tuple(each)) for cause, each in found.values()], key=_place)


def _key(cause: CauseLines | None) -> tuple[object, ...]:
    """Return the key of a group. It is B's line if there is one, even if A also has a line."""
    span = None if cause is None else cause.after or cause.before
    return (None,) if span is None else (cause is not None and cause.after is not None, span.file, span.line)


def _place(group: CausedChanges) -> tuple[bool, bool, str, int]:
    """Return the sort key of a group: recipes before sources, because they are nearest to the user."""
    span = None if group.cause is None else group.cause.after or group.cause.before
    if span is None:
        return True, True, "", 0
    return False, not span.file.endswith(RECIPES), span.file, span.line


def worded(cause: CauseLines | None, a: Side, b: Side) -> CauseLines | None:
    """Return the cause with its lines; if both sides have lines, return only the differing lines."""
    if cause is None:
        return None
    before = block(cause.before, a)
    after = block(cause.after, b)
    if cause.before is not None and cause.after is not None:
        before, after = different(before, after), different(after, before)
    else:
        pairs = ((before, cause.before), (after, cause.after))
        before, after = (lines if is_yaml(span) else lines[:1] for lines, span in pairs)
    ends = ((cause.before, a), (cause.after, b))
    here, there = (None if span is None else side.operand.located(span) for span, side in ends)
    return CauseLines(cause.words, here, there, lines_before=excerpt(before), lines_after=excerpt(after))


ADDRESSES = "address"
COUNTS = "count"


def _choice(given: Given | None, pick: str | None, sample: int | None) -> str | None:
    """Return the choice that the options make, in words, or None if they make none."""
    if given:
        return f"a value for `{next(iter(given))}`"
    if pick is not None:
        return f"the cell `{pick}`"
    return None if sample is None else f"the sample {sample}"


def diff(
    a: str,
    b: str,
    context: Context,
    session: Session,
    *,
    tolerance: float = 0.0,
    only: Collection[str] = (),
    everything: bool = False,
    given: Given | None = None,
    pick: str | None = None,
    sample: int | None = None,
    renders: Path | None = None,
    show: Callable[[Side, Side, Diff], object] | None = None,
) -> Diff | None:
    """Return the differences from A to B, or None if one of them is not a model, which goes to `context.sink`.

    `tolerance` is relative. `only` are kinds of element, `option`, `visual`, `statistic`, `count` and `address`; empty
    means all. `everything` also lists changes that follow from others, instead of only counting them. `given` are
    values of parameters and variants for a recipe, `pick` is a cell of its matrix, and `sample` is one of its samples.
    Pictures of both go to the folder `renders`, and the session must be able to render. `show` is called while the
    session keeps both models.
    """
    with ExitStack() as opened:
        operands = [read_operand(text, context, opened) for text in (a, b)]
        kinds = [operand.kind for operand in operands if operand is not None]
        choice = _choice(given, pick, sample)
        if choice is not None and len(kinds) == 2 and OperandKind.RECIPE not in kinds:
            message = f"you choose {choice}, but neither `{a}` nor `{b}` is a recipe"
            help = "compare the recipe, or the bundle that it gives with these options"
            context.sink.error("unknown-name", message, help=help)
            return None
        sides: list[Side] = []
        for operand, kept in zip(operands, ("diff a", "diff b"), strict=True):
            if operand is None:
                continue
            side = load(operand, kept, session, given=given, pick=pick, sample=sample)
            if side is None or operand.context.sink.has_errors:
                operand.report(context.sink)
            else:
                sides.append(side)
        if len(sides) < 2:
            return None
        first, second = sides
        found = between(first, second, context, session=session, tolerance=tolerance, only=only, everything=everything)
        if found is not None and renders is not None:
            found = replace(found, views=render_views(renders, (first.kept, second.kept), context, session=session))
        if found is not None and show is not None:
            show(first, second, found)
        return None if context.sink.has_errors else found


def between(
    a: Side,
    b: Side,
    context: Context,
    session: Session,
    *,
    tolerance: float = 0.0,
    only: Collection[str] = (),
    everything: bool = False,
) -> Diff | None:
    """Return the differences between two models that the session keeps, or None if MuJoCo crashes.

    A crash is reported.
    """
    answer = engine.call(session, contrast, [a.kept, b.kept], argument={"tolerance": tolerance})
    if not answer.ok:
        message = f"`{a.operand.label}` and `{b.operand.label}` cannot be compared: {answer.error or answer.crash}"
        context.sink.error("mujoco-crash", message)
        return None
    found = contrast_of(answer.value)
    causes = CauseFinder(a, b, found)
    found = _narrowed(found, tolerance, only)
    follows = [each for each in found.changes if each.follows]
    wanted = [each for each in found.changes if not each.follows]
    if everything or not (wanted or found.moves or found.counts):
        wanted = list(found.changes)
        follows = []
    groups = grouped(wanted, causes, a, b=b)
    files = tuple(sorted({path for path, _ in a.digests.items() ^ b.digests.items()}))
    return Diff(a.end, b.end, found, groups=tuple(groups), files=files, follows=len(follows))


def _narrowed(found: Contrast, tolerance: float, only: Collection[str]) -> Contrast:
    """Return the requested kinds. Arrays without a name of their own count only in a bit-for-bit comparison."""
    if not only:
        return found if tolerance == 0 else replace(found, arrays=())
    return replace(
        found,
        changes=tuple(each for each in found.changes if each.kind.partition("/")[0] in only),
        moves=found.moves if ADDRESSES in only else (),
        counts=found.counts if COUNTS in only else (),
        arrays=(),
    )


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
    indexes = [_index_of(side, session, context) for side in (a, b)]
    answer = engine.call(session, looks, [a.kept, b.kept], argument=None)
    if not answer.ok:
        context.sink.error("mujoco-crash", f"the changes cannot be sorted: {answer.error or answer.crash}")
    before, after = indexes
    if before is None or after is None or not answer.ok:
        return None
    contrast = found.contrast
    interface = _interface_of(a) or _interface_of(b)
    sorting = _Sorting({order.kind: order for order in interface}, answer.value)
    renamed = {
        (change.kind, str(change.before)): change.name for change in contrast.changes if change.what == "renamed"
    }
    own = [*_units_and_places(before, after, renamed)]
    by_level = _by_level(contrast, own, sorting)
    causes = CauseFinder(a, b, contrast)
    levels: list[LevelChanges] = []
    for name in LEVELS:
        groups = _groups(by_level.get(name, ()), causes, a, b)
        moves = tuple(move for move in contrast.moves if sorting.of_name(move.kind, move.name) == name)
        arrays = contrast.arrays if name == "minor" and not own else ()
        if groups or moves or arrays:
            levels.append(LevelChanges(name, groups, moves, arrays=arrays))
    return Breaking(found, tuple(levels))


def _index_of(side: Side, session: Session, context: Context) -> CompiledIndex | None:
    names = names_of(side, session, context)
    return None if names is None else names.index


def _by_level(contrast: Contrast, own: Iterable[FieldChange], sorting: _Sorting) -> dict[str, list[FieldChange]]:
    """Return the changes that follow from no other one and those of units and places (`own`), by level."""
    direct = [change for change in contrast.changes if not change.follows] or [*contrast.changes]
    by_level: dict[str, list[FieldChange]] = {}
    for change in (*direct, *own):
        by_level.setdefault(sorting.level(change), []).append(change)
    return by_level


def _interface_of(side: Side) -> Sequence[Order]:
    return side.plan.interface if side.plan is not None else ()


def _groups(changes: Sequence[FieldChange], causes: CauseFinder, a: Side, b: Side) -> tuple[CausedChanges, ...]:
    """Return the changes by cause; changes of a place in an order come first."""
    of_places = [change for change in changes if change.field == "place"]
    others = [change for change in changes if change.field != "place"]
    return (*_reordered(of_places, causes, a, b=b), *grouped(others, causes, a, b=b))


class _Sorting:
    """Sorts changes into levels. `orders` has the interface by kind, and `looks` the visual elements."""

    def __init__(self, orders: Mapping[str, Order], looks: Sequence[Mapping[str, list[int]]]) -> None:
        self.orders = orders
        self.looks = looks

    def of_name(self, kind: str, *names: str) -> str:
        """Return the level of a change in the names, places or meaning of an element."""
        if kind not in KINDS:
            return "minor"
        order = self.orders.get(kind)
        listed = not self.orders or (order is not None and (not order.more or not {*names}.isdisjoint(order.names)))
        return "major" if listed else "minor"

    def level(self, change: FieldChange) -> str:
        kind = change.kind.partition("/")[0]
        field = change.field.partition("[")[0]
        if kind in KINDS and (change.what != "changed" or field in _INTERFACE):
            return self.of_name(kind, change.name, change.name_before)
        if kind in _LOOKS or field.endswith(_LOOK_FIELDS):
            return "patch"
        ids = [(side.get(kind, ()), at) for side, at in zip(self.looks, change.index, strict=True) if at >= 0]
        only_seen = ids and all(at in seen for seen, at in ids)
        return "patch" if only_seen else "minor"


def _units_and_places(
    a: CompiledIndex, b: CompiledIndex, renamed: Mapping[tuple[str, str], str]
) -> Iterator[FieldChange]:
    """Yield changes that no array of `mjModel` has: units of controls and sensors, and the order of elements."""
    for kind in KINDS:
        before, after = (getattr(each, _ROWS.get(kind, f"{kind}s")) for each in (a, b))
        places = {each.name: at for at, each in enumerate(after) if each.name}
        pairs = [
            (at, places[name])
            for at, each in enumerate(before)
            if (name := renamed.get((kind, each.name), each.name)) in places
        ]
        order = [place for _, place in pairs]
        blocks = Alignment(order, sorted(order)).get_matching_blocks()
        kept = {place for block in blocks for place in order[block.a : block.a + block.size]}
        for at, place in pairs:
            one = before[at]
            other = after[place]
            change = FieldChange("changed", kind, other.name, index=(at, place), name_before=one.name)
            units = [getattr(each, "unit", None) for each in (one, other)]
            if units[0] != units[1]:
                yield replace(change, field="unit", before=units[0], after=units[1])
            if place not in kept:
                yield replace(change, field="place", before=at, after=place)


def _reordered(changes: Sequence[FieldChange], causes: CauseFinder, a: Side, b: Side) -> Iterator[CausedChanges]:
    """Yield elements whose order changed, by kind, with the list in `interface` or the first of their lines."""
    for kind in dict.fromkeys(each.kind for each in changes):
        alike = tuple(each for each in changes if each.kind == kind)
        spans = [_listed(side, kind) for side in (a, b)]
        if not any(spans):
            ends = (causes.a, alike[0].name_before), (causes.b, alike[0].name)
            spans = [side.span(side.node(kind, name, -1)) for side, name in ends]
        yield CausedChanges(
            worded(CauseLines(f"the order of {kind}s", spans[0], spans[1]) if any(spans) else None, a, b), alike
        )


def _listed(side: Side, kind: str) -> Span | None:
    if side.plan is None or find(side.plan.document, ("interface", kind)) is None:
        return None
    return locate(side.plan.document, ("interface", kind), key=True)
