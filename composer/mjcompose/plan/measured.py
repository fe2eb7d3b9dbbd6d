"""Read the file of measurements that a recipe uses, and turn its numbers into entries of `edit`."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping as Map
from dataclasses import replace
from pathlib import Path

from mjcompose.base.access import Door
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.files import Refused, TooLarge, read_regular, unsaved_text
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean
from mjcompose.language.measured import (
    COUNTS,
    DELAY,
    TOPICS,
    ZERO,
    MeasuredValue,
    MeasurementFile,
    UseMeasured,
    in_si,
    values_of,
)
from mjcompose.language.select import kinds_of
from mjcompose.language.value import attribute_and_index
from mjcompose.language.variation import read
from mjcompose.sources.context import Context
from mjcompose.sources.fetching import nearest
from mjcompose.text.expression import Angle
from mjcompose.text.load import load, refuse_size
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence, find, locate, to_python
from mjcompose.tree.pattern import fitter, is_pattern

KEY = "measured"
_EDIT = "edit"
NumberPlace = tuple[tuple[str, ...], str]
"""The path of a number in a file of measurements, and the name in the recipe of an element with it."""
Replaced = Map[NumberPlace, float]
"""Numbers that take the place of those in the file, in MuJoCo's units."""


class Measurements(Struct):
    """A file of measurements as a recipe uses it. `span` is the place in the recipe that names it.

    `values` are all numbers of the file, and `topics` has the hash of each topic that the file says.
    """

    path: Path
    shown: str
    use: UseMeasured
    file: MeasurementFile
    document: Mapping
    values: tuple[MeasuredValue, ...]
    topics: Map[str, str]
    span: Span

    @property
    def applied(self) -> Iterator[MeasuredValue]:
        """Yield the numbers that the model gets, each with the names of the elements that get it."""
        yield from self.applied_with({})

    def applied_with(self, replaced: Replaced) -> Iterator[MeasuredValue]:
        """Yield the same, and numbers with a replacement."""
        for value in self.values:
            names = tuple(
                name for name in self.selected_names(value) if value.is_applied or (value.path, name) in replaced
            )
            if names:
                yield replace(value, names=names)

    def selected_names(self, value: MeasuredValue) -> tuple[str, ...]:
        """Return the names of the elements of a number that `only` selects."""
        return tuple(name for name in value.names if self._is_selected(value.kind, name))

    def _is_selected(self, kind: str, name: str) -> bool:
        only = self.use.only
        return not only or (kind in only and _fits(only[kind], name))

    def span_of(self, value: MeasuredValue, key: bool = False) -> Span:
        return locate(self.document, value.path, key=key)


def read_measurements(use: UseMeasured, document: Mapping, folder: Path, context: Context) -> Measurements | None:
    """Return the file that the recipe `document` in `folder` names, or None after reported errors."""
    at = (KEY, "file") if isinstance(find(document, (KEY,)), Mapping) else (KEY,)
    span = locate(document, at)
    path = folder / use.file
    shown = context.shown(path)
    text = _text(path, shown, folder, span, context=context)
    tree = None if text is None else load(text, shown, context.sink)
    if tree is None:
        return None
    written = to_python(tree)
    if not isinstance(tree, Mapping):
        help = "write `measured: 1` as its first line; `mjcompose identify` writes such files"
        context.sink.error("wrong-type", f"`{shown}` is not a file of measurements", tree.span, help=help)
        return None
    file: MeasurementFile | None = read(MeasurementFile, written, tree, at=(), sink=context.sink)
    if file is None:
        return None
    topics = {topic: str(file.recipe[topic]) for topic in TOPICS if topic in file.recipe}
    measurements = Measurements(
        path, shown, use, file, document=tree, values=tuple(values_of(file, use)), topics=topics, span=span
    )
    errors = [*_idle_keys(measurements, document), *_clashes(measurements)]
    for error in errors:
        context.sink.add(error)
    return None if errors else measurements


def _fits(glob: str, name: str) -> bool:
    return fitter(glob, lambda: [name], "/")(name)


def _idle_keys(measurements: Measurements, document: Mapping) -> Iterator[Diagnostic]:
    """Yield an error for each name of `rename` and `only` that no element of the file has."""
    use = measurements.use
    names = [name for _, first, _, number in measurements.file.numbers for name in (first, *number.also)]
    used = {use.renamed_by(name) for name in names}
    for old in use.rename:
        if old not in used:
            message = f"`{old}` in `rename` is the name of no element in `{measurements.shown}`"
            span = locate(document, (KEY, "rename", old), key=True)
            yield Diagnostic("unknown-name", message, span, help=did_you_mean(old, names) or "remove it")
    for kind, glob in use.only.items():
        of_kind = [name for value in measurements.values if value.kind == kind for name in value.names]
        if not any(_fits(glob, name) for name in of_kind):
            message = f"`{kind}: {glob}` in `only` selects no number of `{measurements.shown}`"
            span = locate(document, (KEY, "only", kind))
            help = did_you_mean(glob, of_kind) or "it selects names of this recipe, which `rename` gave"
            yield Diagnostic("selector", message, span, help=help)


def _clashes(measurements: Measurements) -> Iterator[Diagnostic]:
    """Yield an error for each second number of an attribute of an element."""
    first: dict[tuple[str, str, str], MeasuredValue] = {}
    for value in measurements.applied:
        for name in value.names:
            attribute = value.attribute.removesuffix("[0]")
            other = first.setdefault((value.kind, name, attribute), value)
            if other.path != value.path:
                message = f"`{attribute}` of {value.kind} `{name}` has two numbers"
                note = Note("the other one is here", measurements.span_of(other, key=True))
                help = "remove one of them, or correct `rename` and `also`, which give elements the same name"
                span = measurements.span_of(value, key=True)
                yield Diagnostic("name-clash", message, span, notes=(note,), help=help)


def _text(path: Path, shown: str, folder: Path, span: Span, context: Context) -> bytes | None:
    # A recipe that MJCF attaches may read no more than that MJCF, whose folders are not known here.
    door = Door.of([folder]) if context.attaching else context.door_of_text(folder)
    if not door.sees(path):
        door.outside(str(path)).report(context.sink, span, shown=context.shown)
        return None
    if (kept := unsaved_text(path)) is not None:
        return kept
    try:
        return read_regular(path, in_force().recipe_size)
    except Refused as error:
        context.sink.error("file-unreadable", f"`{shown}` {error.why}", span, help="name a file of measurements")
    except TooLarge:
        refuse_size(shown, context.sink)
    except FileNotFoundError:
        near = _near(path)
        help = f"did you mean `{near}`?" if near else "`mjcompose identify` writes it from a recording"
        context.sink.error("file-not-found", f"the file of measurements `{shown}` does not exist", span, help=help)
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        context.sink.error("file-unreadable", f"`{shown}` cannot be read: {why}", span)
    return None


def _near(path: Path) -> str | None:
    try:
        names = sorted(each.name for each in path.parent.iterdir() if each.suffix in (".yaml", ".yml"))
    except OSError:
        return None
    return nearest(path.name, names)


def with_edits(document: Mapping, measurements: Measurements, replaced: Replaced | None = None) -> Mapping:
    """Return the recipe with an entry of `edit` for each measured number, after its own entries."""
    replaced = replaced or {}
    entries: list[Mapping] = []
    of_bodies: dict[str, list[MeasuredValue]] = {}
    for value in measurements.applied_with(replaced):
        for name in value.names:
            if attribute_and_index(value.attribute)[0] in COUNTS:
                of_bodies.setdefault(name, []).append(value)
            else:
                entries.append(_entry(measurements, value, name, replaced.get((value.path, name))))
    entries += [_inertia_entry(measurements, values, name, replaced) for name, values in of_bodies.items()]
    key, written = document.entries.get(_EDIT, (Key(_EDIT, measurements.span), Sequence((), measurements.span)))
    if not isinstance(written, Sequence):
        return document
    edits = Sequence((*written.items, *entries), written.span)
    return Mapping({**document.entries, _EDIT: (key, edits)}, document.span)


def _entry(measurements: Measurements, value: MeasuredValue, name: str, replacement: float | None) -> Mapping:
    """Return the entry for one element; its names and values have their places in the file."""
    owner = locate(measurements.document, value.path[:-1], key=True)
    at_number = measurements.span_of(value, key=True)
    number = locate(measurements.document, (*value.path, "value"))
    verb = "calibrate" if value.attribute in (ZERO, DELAY) else "set"
    new = value.number.value
    if replacement is not None:
        new = Angle(replacement, "rad") if isinstance(new, Angle) else replacement
    changes = _mapping({word_for_set(value): _scalar(new, number)}, at_number)
    return _entry_of(verb, changes, _selector(value.kind, name, owner))


def _inertia_entry(measurements: Measurements, values: list[MeasuredValue], name: str, replaced: Replaced) -> Mapping:
    """Return the entry for the center of mass and the shape of the inertia of a body."""
    owner = locate(measurements.document, values[0].path[:-1], key=True)
    at_first = measurements.span_of(values[0], key=True)
    lists: dict[str, list[Node]] = {}
    for value in values:
        base, index = attribute_and_index(value.attribute)
        assert index is not None  # the file is checked
        number = locate(measurements.document, (*value.path, "value"))
        nodes = lists.setdefault(base, [_scalar(0.0, at_first) for _ in range(COUNTS[base])])
        nodes[index] = _scalar(replaced.get((value.path, name), in_si(value.number.value)), number)
    changes = _mapping({base: Sequence(tuple(nodes), at_first) for base, nodes in lists.items()}, at_first)
    return _entry_of("calibrate", changes, _selector("body", name, owner))


def _entry_of(verb: str, changes: Mapping, selector: Mapping) -> Mapping:
    # An element that does not exist is reported with the names of the model, when that is composed.
    optional = _scalar(True, selector.span)
    return _mapping({"select": selector, "optional": optional, verb: changes}, changes.span)


def word_for_set(value: MeasuredValue) -> str:
    """Return the attribute of a number with an index if it may have several: the others keep their values."""
    attributes = [each.attributes.get(value.attribute) for each in kinds_of(value.kind)]
    has_several = any(
        each is not None and each.min_length == 1 and each.max_length != 1 and isinstance(each.default, tuple)
        for each in attributes
    )
    return f"{value.attribute}[0]" if has_several else value.attribute


def _selector(kind: str, name: str, span: Span) -> Mapping:
    if not is_pattern(name):
        return _mapping({kind: _scalar(name, span)}, span)
    everything = {kind: _scalar("**", span), "where": _scalar(condition_of(name), span)}
    return _mapping(everything, span)


def condition_of(name: str) -> str:
    """Return the `where` that selects a name with characters of a glob.

    >>> condition_of("el{bow}")
    '${name == "el{bow}"}'
    """
    return f"${{name == {json.dumps(name)}}}"


def _mapping(entries: Map[str, Node], span: Span) -> Mapping:
    return Mapping({name: (Key(name, span), node) for name, node in entries.items()}, span)


def _scalar(value: float | str | bool | Angle, span: Span) -> Scalar:
    if isinstance(value, Angle):
        return Scalar(str(value), span, str(value), plain=True)
    return Scalar(value, span, str(value), plain=True)


def check_names(measurements: Measurements, known: Map[str, list[str]], sink: Sink) -> None:
    """Report each element of the file that the model does not have; `known` has the names of each kind."""
    reported: set[tuple[str, str]] = set()
    for value in measurements.applied:
        for name in value.names:
            if name in known[value.kind] or (value.kind, name) in reported or sink.suppresses(name):
                continue
            reported.add((value.kind, name))
            meant = did_you_mean(name, known[value.kind])
            rename = 'a part with another prefix: `measured: {file: …, rename: {"left/**": "arm/**"}}`'
            message = f"`{measurements.shown}` has numbers of {value.kind} `{name}`, which the model does not have"
            span = locate(measurements.document, value.path[:-1], key=True)
            help = rename if meant is None else f"{meant} {rename}"
            sink.error("unknown-name", message, span, help=help, subjects=(name,))
