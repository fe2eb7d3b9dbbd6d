"""Validate a located tree: a `Recipe`, and every fault as a diagnostic."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import replace
from itertools import islice

from pydantic import ValidationError

from composer.diagnostics import Note, Sink, Span
from composer.diagnostics.fix import Fix
from composer.diagnostics.suggest import closest
from composer.document.node import Mapping, Node, Scalar, find, locate, to_python
from composer.limits import in_force
from composer.recipe import errors
from composer.recipe.fault import Fault, Path
from composer.recipe.in_place import faults_in_place
from composer.recipe.raw import raw
from composer.recipe.recipe import Recipe
from composer.recipe.recovery import Recovered, existing_steps, recover
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of

_UNKNOWN = ("unknown-key", "unknown-attribute", "unknown-element")
_SEVERAL = 4


def validate(node: Node, sink: Sink) -> Recipe | None:
    """Return the recipe of a located tree, or None after reported errors.

    Names, files and model references are not looked up. It does no I/O.
    """
    if not isinstance(node, Mapping):
        _no_mapping(node, sink)
        return None
    recipe, faults = judge(node)
    _report(faults, node, sink)
    return recipe


def validate_what_remains(node: Node, sink: Sink, gone: Collection[Path] = ()) -> Recovered | None:
    """Return the recipe without the pieces that have faults, or None if too little would remain.

    `gone` are the paths of keys whose values have faults that are already reported. These keys do not count as missing.
    """
    if not isinstance(node, Mapping):
        _no_mapping(node, sink)
        return None
    recipe, faults = judge(node)
    if recipe is not None:
        return Recovered(recipe, node, frozenset())
    _report((each for each in faults if not _follows(each, node, gone)), node, sink)
    return recover(node, faults, judge)


def judge(node: Mapping) -> tuple[Recipe | None, list[Fault]]:
    """Return the recipe of a located tree, or None and all of its faults."""
    early: list[Fault] = []
    data = raw(node, early)
    recipe: Recipe | None = None
    found: list[Fault] = []
    most = in_force().faults
    try:
        recipe = Recipe.model_validate(data, context=Settings.of(data))
    except ValidationError as error:
        found = list(islice(errors.faults(error, data), most + 1))
        if len(found) > most:  # each takes a search for what was meant; the sink says that there are too many
            return None, found
    found += faults_in_place(node, lambda model: judge(model)[1])
    if not early and not found:
        return recipe, []
    version = [fault for fault in found if fault.code == "recipe-version"]
    remaining = list(_without_misspelt(list(_one_each(early, found))))
    return None, version or list(_without_strangers(remaining))


def _follows(fault: Fault, node: Mapping, gone: Collection[Path]) -> bool:
    """Whether a fault is about a mapping that lacks something only because that is `gone`."""
    at = existing_steps(node, _mapping_of(fault))
    if fault.lacks is not None:
        return (*at, fault.lacks) in gone
    if all(each[:-1] != at for each in gone):
        return False
    mapping = find(node, at)
    is_empty = isinstance(mapping, Mapping) and not mapping.entries
    return fault.code == "missing-key" or (fault.code == "wrong-type" and is_empty)


def _no_mapping(node: Node, sink: Sink) -> None:
    sink.error(
        "wrong-type",
        f"a recipe is a mapping, got {kind_of(to_python(node))}",
        _start(node.span),
        help="write `recipe: 1` as its first line, and the other keys below",
    )


def _one_each(early: list[Fault], found: list[Fault]) -> Iterable[Fault]:
    """Yield the faults to report.

    If a place has a fault of its own, then that its value is not an expected one is left out.
    """
    unknown = {fault.at for fault in found if fault.key}
    kept = [fault for fault in early if not any(fault.at[:n] in unknown for n in range(1, len(fault.at) + 1))]
    settled = {fault.at for fault in kept}
    yield from kept
    yield from (fault for fault in found if fault.key or fault.at not in settled)


def _without_misspelt(faults: list[Fault]) -> Iterator[Fault]:
    """Return the faults without those that a misspelled key causes twice, as an unknown and as a missing key."""
    lacking = {(_mapping_of(fault), fault.lacks): fault for fault in faults if fault.lacks is not None}
    keys_of: dict[Path, list[str]] = {}
    for at, key in lacking:
        keys_of.setdefault(at, []).append(str(key))
    found: list[Fault] = []
    for fault in faults:
        if lacking and fault.code in _UNKNOWN and fault.key:
            keys = [key for key in keys_of.get(fault.at[:-1], ()) if (fault.at[:-1], key) in lacking]
            if near := closest(str(fault.at[-1]), keys):
                del lacking[fault.at[:-1], near[0]]
                fix = Fix(near[0], str(fault.at[-1]))
                fault = replace(fault, help=f"write `{near[0]}`", fix=fix)
        found.append(fault)
    return (each for each in found if each.lacks is None or (_mapping_of(each), each.lacks) in lacking)


def _mapping_of(fault: Fault) -> Path:
    """Return the mapping that lacks a key."""
    return fault.at[:-1] if fault.beside else fault.at


def _without_strangers(faults: list[Fault]) -> Iterator[Fault]:
    """Yield the faults, with one instead of several for a mapping that is of another kind or in a wrong place."""
    strangers: dict[Path, list[Fault]] = {}
    for fault in faults:
        if fault.code in _UNKNOWN and fault.key and len(fault.at) > 1:
            strangers.setdefault(fault.at[:-1], []).append(fault)
    several = {at: found for at, found in strangers.items() if len(found) >= _SEVERAL}
    for fault in faults:
        first, *others = several.get(fault.at[:-1], [fault]) if fault.code in _UNKNOWN else [fault]
        if fault is first and others:
            keys = ", ".join(f"`{each.at[-1]}`" for each in others)
            note = Note(f"the same is true of {keys}")
            help = "is it in the right section? its indentation says to what it belongs"
            yield replace(fault, notes=(note, *fault.notes), help=help, fix=None)
        elif fault is first and not (fault.code == "missing-key" and fault.at in several):
            yield fault


def _report(faults: Iterable[Fault], node: Mapping, sink: Sink) -> None:
    for fault in faults:
        related = (Note(message, locate(node, at, key=True)) for message, at in fault.related)
        notes = (*fault.notes, *related)
        message, span = fault.message, _span(node, fault.at, fault.key)
        if fault.within is not None:
            line, column, width = fault.within
            text = find(node, fault.at)
            if isinstance(text, Scalar) and text.block is not None:
                line, column = line + text.block[0] - 1, column + text.block[1] - 1
                span = Span(span.file, line, column, end_line=line, end_column=column + width)
            else:
                message = f"line {line} of the fragment: {message}"
        sink.error(fault.code, message, span, notes=notes, help=fault.help, fix=fault.fix)


def _span(node: Mapping, path: Path, key: bool) -> Span:
    return _start(node.span) if not path else locate(node, path, key=key)


def _start(span: Span) -> Span:
    return Span(span.file, span.line, span.column)
