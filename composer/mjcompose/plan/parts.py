"""The parts of a recipe, their places, and the pieces of a recipe for other builds."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping as Map, Sequence as AbcSequence, Set
from itertools import product
from pathlib import Path

from mjcompose.base.access import Door
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.files import Refused
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest, renaming, unknown_name
from mjcompose.language.attach import Axis
from mjcompose.language.checks.unchanged import Unchanged
from mjcompose.language.condition import has_conditions
from mjcompose.language.expand import expand
from mjcompose.language.keyframe import FROM
from mjcompose.language.parameters import choose, node_of, read_axes
from mjcompose.language.validate import validate_what_remains
from mjcompose.plan.plan import AttachPart, Plan, part_name
from mjcompose.sources.context import Context
from mjcompose.sources.reference import Source
from mjcompose.text.merge import is_appended
from mjcompose.text.node import Mapping, Node, Scalar, Sequence, is_template, locate, spans
from mjcompose.tree.files import is_recipe, join
from mjcompose.tree.parse import parse_file

Copy = tuple[int, ...]
"""The number of a copy on each axis, from 0."""


def copies(axes: AbcSequence[Axis]) -> Iterator[tuple[str, Copy]]:
    """Yield the suffix of each copy after the part's prefix, and its numbers; the last axis runs first.

    >>> [suffix for suffix, _ in copies([Axis(count=2), Axis(count=11)])][9:12]
    ['0_09', '0_10', '1_00']
    """
    widths = [len(str(axis.copies - 1)) for axis in axes]
    for copy in product(*(range(axis.copies) for axis in axes)):
        numbers = (str(number).zfill(width) for number, width in zip(copy, widths, strict=True))
        yield "_".join(numbers), copy


def without_rings(parts: tuple[AttachPart, ...], separator: str, sink: Sink) -> tuple[AttachPart, ...]:
    """Report parts that are attached to one another in a loop; return the other parts."""
    mounts = _mounts(parts)
    rings = _rings(mounts)
    reported: set[str] = set()
    for part in parts:
        if part.prefix in reported or part.prefix not in rings:
            continue
        ring = _ring_from(part.prefix, mounts)
        reported.update(ring)
        names = ", which is attached to ".join(f"`{prefix}`" for prefix in [*ring[1:], part.prefix])
        alone = len(ring) == 1
        message = f"`{part.prefix}` is attached to {'itself' if alone else names}"
        help = f"{'it' if alone else 'one of them'} must be attached to the base or to the world"
        sink.error("attach-cycle", message, part.span, help=help, subjects=ring)
    if reported:
        sink.suppress_about(part_name(part, separator) for part in parts if part.prefix in reported)
    return tuple(part for part in parts if part.prefix not in reported)


def _mounts(parts: tuple[AttachPart, ...]) -> dict[str, str | None]:
    """Return the prefix of the part that each part is attached to: the longest prefix of the name of its place."""
    prefixes = {part.prefix for part in parts if part.prefix}
    lengths = sorted({len(prefix) for prefix in prefixes}, reverse=True)
    mounts: dict[str, str | None] = {}
    for part in parts:
        place = part.attachment.site or part.attachment.body or part.attachment.frame or ""
        starts = (place[:length] for length in lengths if length <= len(place))
        mounts[part.prefix] = next((start for start in starts if start in prefixes), None)
    return mounts


def _rings(mounts: Map[str, str | None]) -> set[str]:
    """Return the prefixes of parts that carry themselves. Each part is visited once."""
    rings: set[str] = set()
    seen: set[str] = set()
    for prefix in mounts:
        path: dict[str, None] = {}
        mount: str | None = prefix
        while mount is not None and mount not in seen:
            seen.add(mount)
            path[mount] = None
            mount = mounts.get(mount)
        if mount is not None and mount in path:
            rings.update(_ring_from(mount, mounts))
    return rings


def _ring_from(prefix: str, mounts: Map[str, str | None]) -> list[str]:
    ring = [prefix]
    while (mount := mounts[ring[-1]]) is not None and mount != prefix:
        ring.append(mount)
    return ring


def check_part_names(plan: Plan, sink: Sink) -> None:
    """Report names in checks and keys that are not parts of the recipe, or are ambiguous."""
    parts = list(plan.part_names)
    for check in plan.checks:
        if isinstance(check, Unchanged) and check.part is not None and check.part not in parts:
            near = closest(check.part, parts)
            message = f"check `{check.name}` is about `{check.part}`, which is not a part of this recipe"
            sink.add(
                unknown_name(
                    "part",
                    check.part,
                    parts,
                    span=locate(plan.document, (*check.at, "part")),
                    message=message,
                    help=f"write `part: {near[0]}`" if near else None,
                    fix=renaming(check.part, parts),
                    about=(check.name,),
                )
            )
    _check_mirrors(plan, sink)
    for key in (step.key for step in plan.keyframes):
        for part in key.sources:
            span = locate(plan.document, (*key.at, FROM, part), key=True)
            if parts.count(part) > 1:
                message = f"`{part}` is the prefix of one part, and the key of another part that has no prefix"
                help = "give the part without a prefix another key"
                sink.error("name-clash", message, span, help=help, subjects=(part,))
            elif part not in parts:
                sink.add(unknown_name("part", part, parts, span=span, purpose=" to take a key from"))


def _check_mirrors(plan: Plan, sink: Sink) -> None:
    """Report parts that do not mirror exactly one part, or that mirror a mirror image."""
    by_name = {part_name(part, plan.separator): part for part in plan.parts if not part.copy}
    for part in (planned for planned in plan.parts if planned.attachment.mirror is not None):
        assert part.attachment.mirror is not None
        of = part.attachment.mirror.of
        name = part_name(part, plan.separator)
        span = locate(plan.document, (*part.at, "mirror", "of"))
        other = by_name.get(of)
        if other is None:
            sink.add(unknown_name("part", of, by_name, span=span, purpose=f" that `{name}` mirrors"))
        elif other.attachment.mirror is not None:
            message = f"`{name}` mirrors `{of}`, which mirrors another part itself"
            help = "mirror a part that has a place of its own"
            sink.error("attach-cycle", message, span, help=help, subjects=(name,))


# These may be correct in a build that also chooses another piece.
_MAY_BE_ELSEWHERE = ("missing-key", "expression", "unknown-name")


def check_pieces(document: Mapping, given: Map[str, Node], sink: Sink) -> None:
    """Report faults in pieces of a recipe that a build leaves out: by `when`, or `variants` that are not chosen."""
    if has_conditions(document):
        _report_faults(document, given, None, sink=sink)
    pieces = list(_pieces_left_out(document, given))
    for axis, value, piece in _suspects(pieces, document, given):
        _report_faults(document, {**given, axis: value}, set(spans(piece)), sink=sink)


Piece = tuple[str, Node, Node]
"""The name of an axis, one of its values, and the part of the recipe that this value adds."""


def _pieces_left_out(document: Mapping, given: Map[str, Node]) -> Iterator[Piece]:
    axes = read_axes(document, Sink())
    chosen = choose(axes, given, Sink())
    for axis, values in axes.items():
        for value, (key, piece) in values.entries.items():
            if value != chosen.get(axis):
                yield axis, node_of(value, key.span), piece


def _suspects(pieces: list[Piece], document: Mapping, given: Map[str, Node]) -> list[Piece]:
    """Return the pieces that may have faults, in their order.

    Validating the whole recipe for each piece would take N² time for N axes. Pieces that write different things are
    validated together.
    """
    suspects: set[int] = set()
    for together in _rounds(pieces):
        faults = _faults(document, {**given, **{axis: value for axis, value, _ in together}})
        places = {fault.span for fault in faults}
        suspects |= {id(piece) for *_, piece in together if not places.isdisjoint(spans(piece))}
    return [each for each in pieces if id(each[2]) in suspects]


class _Round:
    """Pieces of different axes that write different things: no piece hides another one."""

    def __init__(self) -> None:
        self.pieces: list[Piece] = []
        self._axes: set[str] = set()
        self._written: set[tuple[str, str]] = set()
        self._sections: set[str] = set()
        self._replaced: set[str] = set()

    def takes(self, axis: str, written: Set[tuple[str, str]]) -> bool:
        if axis in self._axes or not self._written.isdisjoint(written):
            return False
        replaced = {section for section, name in written if name == _WHOLE}
        sections = {section for section, _ in written}
        return self._sections.isdisjoint(replaced) and self._replaced.isdisjoint(sections)

    def add(self, piece: Piece, written: Set[tuple[str, str]]) -> None:
        self.pieces.append(piece)
        self._axes.add(piece[0])
        self._written |= written
        self._sections |= {section for section, _ in written}
        self._replaced |= {section for section, name in written if name == _WHOLE}


def _rounds(pieces: Iterable[Piece]) -> Iterator[list[Piece]]:
    """Distribute pieces to as few rounds as the order allows."""
    rounds: list[_Round] = []
    for piece in pieces:
        written = _written(piece[2])
        fitting = next((each for each in rounds if each.takes(piece[0], written)), None)
        if fitting is None:
            fitting = _Round()
            rounds.append(fitting)
        fitting.add(piece, written)
    yield from (each.pieces for each in rounds)


_WHOLE = ""
"""The place of a section that a piece replaces as a whole."""


def _written(piece: Node) -> set[tuple[str, str]]:
    """Return the section and the name of all that a piece writes. Lists to which it appends are left out."""
    written: set[tuple[str, str]] = set()
    if isinstance(piece, Mapping):
        for section, (_, value) in piece.entries.items():
            if isinstance(value, Mapping):
                written |= {(section, name) for name in value.entries}
            elif not (is_appended((section,)) and isinstance(value, Sequence) and not any(map(_has_id, value.items))):
                written.add((section, _WHOLE))
    return written


def _has_id(item: Node) -> bool:
    return isinstance(item, Mapping) and "id" in item.entries


def _faults(document: Mapping, given: Map[str, Node]) -> list[Diagnostic]:
    """Return the faults of a build that includes the items of all builds."""
    aside = Sink()
    validate_what_remains(expand(document, given, aside, any=True).document, aside)
    return [fault for fault in aside.errors if fault.code not in _MAY_BE_ELSEWHERE]


def _report_faults(document: Mapping, given: Map[str, Node], places: Set[Span] | None, sink: Sink) -> None:
    """Report the faults in these places of a build that includes the items of all builds."""
    computed = set(_computed(document))
    for fault in _faults(document, given):
        if (places is None or fault.span in places) and fault.span not in computed:
            sink.add(fault)


def _computed(node: Node) -> Iterator[Span]:
    """Yield the places of computed values, which differ in their own build, and of lists of such values."""
    if isinstance(node, Scalar):
        if isinstance(node.value, str) and is_template(node.value):
            yield node.span
        return
    items = node.items if isinstance(node, Sequence) else [value for _, value in node.entries.values()]
    if isinstance(node, Sequence) and any(isinstance(item, Scalar) and is_template(item.text) for item in items):
        yield node.span
    for item in items:
        yield from _computed(item)


_OF_MODELS = ("base", "model", "with")
_OF_PIECES = ("variants", "matrix")


def parameters_choose(recipe: Node | None) -> bool:
    """Return whether a parameter can change the models: by `when`, `for`, or an expression in a reference. No I/O."""
    waiting = [(recipe, False)]
    while waiting:
        node, naming = waiting.pop()
        if isinstance(node, Scalar):
            if naming and "${" in node.text:
                return True
        elif isinstance(node, Sequence):
            waiting += [(each, naming) for each in node.items]
        elif isinstance(node, Mapping):
            if not node.entries.keys().isdisjoint(("when", "for")):
                return True
            waiting += [(value, naming or name in _OF_MODELS) for name, (_, value) in node.entries.items()]
    return False


def is_one_choice(recipe: Node | None) -> bool:
    """Return whether a recipe has the same models in all its builds. No I/O."""
    pieces = isinstance(recipe, Mapping) and any(name in recipe.entries for name in _OF_PIECES)
    return not pieces and not parameters_choose(recipe)


_NAMED = re.compile(rb"""<(?:model|include)\b[^>]*?\bfile\s*=\s*["']([^"']+)["']""")


def inner_recipes(source: Source, context: Context) -> Iterator[tuple[Path, Path, Span]]:
    """Yield the recipes that a model attaches: file, folder of the MJCF that names it, place. Others are reported."""
    # Few models attach recipes, and a look at the text takes a fraction of the time of parsing it.
    if source.format == "mjcf" and _reaches(source.path, source.path.parent, source.door, seen=set()):
        yield from _recipes(source.path, source.door, context, seen=set())


def _reaches(path: Path, main: Path, door: Door, seen: set[Path]) -> bool:
    """Return whether a file, or a file that it includes or attaches, names a recipe."""
    if path in seen:
        return False
    seen.add(path)
    try:
        data = door.read(path, in_force().xml_size)
    except (Refused, OSError, ValueError):  # ValueError for a name with NUL; reported when the model is read
        return False
    names = {os.fsdecode(name) for name in _NAMED.findall(data)}
    folders = {main, path.parent}
    return any(map(is_recipe, names)) or any(
        _reaches(Path(join(str(folder), name)), main, door, seen=seen) for name in names for folder in folders
    )


def _recipes(path: Path, door: Door, context: Context, seen: set[Path]) -> Iterator[tuple[Path, Path, Span]]:
    seen.add(path)
    unit = parse_file(path, Sink(), file=context.shown(path), door=door)
    if unit is not None:
        for element in unit.root.iterfind("asset/model"):
            assert unit is not None
            inner = Path(join(str(unit.directory), str(element.get("file") or "")))
            if inner in seen:
                continue
            if not is_recipe(inner.name):
                yield from _recipes(inner, door, context, seen=seen)
                continue
            seen.add(inner)
            span = unit.origins.span(element, unit.file, "file")
            try:
                door.admit(inner)
            except Refused as refused:
                refused.report(context.sink, span, shown=context.shown)
            else:
                yield inner, unit.directory, span
