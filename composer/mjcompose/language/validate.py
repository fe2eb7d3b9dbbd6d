"""Turn a located tree into a `Recipe`, and every fault into a diagnostic."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping as AbcMapping, Sequence
from dataclasses import replace
from itertools import islice
from typing import Any, cast

from pydantic import ValidationError

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Fix, Note, Path
from mjcompose.base.files import MESH_FILES, MODEL_FILES
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest
from mjcompose.base.words import value_text
from mjcompose.language.attach import Attachment
from mjcompose.language.element import raw
from mjcompose.language.forms.context import Settings
from mjcompose.language.forms.model import fields_of
from mjcompose.language.forms.translate import misspelt, report, translated
from mjcompose.language.placing import faults_in_place
from mjcompose.language.recipe import VERSION, Recipe, sections_of
from mjcompose.language.sections import ByTag, Typed
from mjcompose.language.value import kind_of
from mjcompose.text.node import Key, Mapping, Node, Scalar, Sequence as List, find, texts, to_python
from mjcompose.tree.grammar import GRAMMAR

# Without these, nothing else in the recipe can be checked.
_INDISPENSABLE = ("recipe", "separator", "base")
# Without these, a part is another one, or is attached in another way.
_MAKING = ("subtree", "joint", "sense", "drop", "edit", "prefix", "replicate", "with", "keys")
# Sections in which parts may disagree, as `conflict` allows.
_AGREED = ("option", "size", "statistic", "visual")
_ROUNDS = 8

Judge = Callable[[Mapping], tuple[Recipe | None, list[Fault]]]


class TrimmedRecipe(Struct):
    """A recipe without faults, its located tree, and every omitted name and value."""

    recipe: Recipe
    document: Mapping
    lost: frozenset[str]


def recover(node: Mapping, faults: Sequence[Fault], judge: Judge) -> TrimmedRecipe | None:
    """Return the recipe without the smallest pieces that have `faults`, or None if too little would remain. No I/O."""
    lost: set[str] = set()
    for _ in range(_ROUNDS):
        for path in _outermost(_whole(existing_steps(node, fault.at)) for fault in faults):
            if not path or (len(path) == 1 and _means(path[0], _INDISPENSABLE)):
                return None
            lost.update([path[-1]] if isinstance(path[-1], str) else [], texts(find(node, path) or node))
            if _means(path[0], ("conflict",)):
                lost.update(_AGREED)
            node = cast(Mapping, _cut(node, path))
            if _means(path[0], ("angle",)) and len(path) == 1:  # so no missing unit is reported
                unit = Key("angle", node.span), Scalar("radian", node.span, "radian", plain=True)
                node = Mapping({**node.entries, "angle": unit}, node.span)
        recipe, faults = judge(node)
        if recipe is not None:
            return TrimmedRecipe(recipe, node, frozenset(lost))
    return None


def _whole(path: Path) -> Path:
    is_made = len(path) == 3 and path[0] == "attach" and _means(path[2], _MAKING, Attachment.model_fields)
    return path[:2] if is_made else path


def _means(key: str | int, keys: Collection[str], known: Collection[str] = tuple(Recipe.model_fields)) -> bool:
    near = [str(key)] if key in known else closest(str(key), known)
    return any(meant in keys for meant in near)


def existing_steps(node: Node, path: Path) -> Path:
    """Return the steps of a validator's path that exist in the data."""
    found: list[str | int] = []
    for step in path:
        if isinstance(node, Mapping) and isinstance(step, str) and step in node.entries:
            node = node.entries[step][1]
        elif isinstance(node, List) and isinstance(step, int) and 0 <= step < len(node.items):
            node = node.items[step]
        else:
            continue
        found.append(step)
    return tuple(found)


def _outermost(paths: Iterator[Path]) -> list[Path]:
    """Return the paths that are not inside another path, from the end of the file to its start."""
    kept: list[Path] = []
    for path in sorted(set(paths), key=len):
        if not any(path[: len(each)] == each for each in kept):
            kept.append(path)
    return sorted(kept, key=lambda path: [step if isinstance(step, int) else -1 for step in path], reverse=True)


def _cut(node: Node, path: Path) -> Node:
    step, *rest = path
    if isinstance(node, Mapping):
        entries: dict[str, tuple[Key, Node]] = dict(node.entries)
        assert isinstance(step, str)
        key, value = entries.pop(step)
        if rest:
            entries = {**node.entries, step: (key, _cut(value, tuple(rest)))}
        return Mapping(entries, node.span)
    assert isinstance(node, List) and isinstance(step, int)
    items = list(node.items)
    items[step : step + 1] = [_cut(items[step], tuple(rest))] if rest else []
    return List(tuple(items), node.span)


def faults(error: ValidationError, data: Any) -> Iterator[Fault]:
    """Yield the faults of a validation, from the top of `data`. A misspelled key is one fault, not two."""
    errors = error.errors(include_url=False)
    meant = {id(detail) for detail in misspelt(errors, Recipe, data).values()}
    parts = part_keys(data) if isinstance(data, AbcMapping) else {}
    stray = [*parts]
    for detail in errors:
        if id(detail) in meant:
            continue
        fault = translated(detail, Recipe, data)
        if detail["type"] == "missing" and detail["loc"] == ("recipe",):
            message = "the recipe does not say which version of the language it is written in"
            help = f"write `recipe: {VERSION}` as its first line"
            fault = Fault("missing-key", message, help=help, fix=Fix(f"recipe: {VERSION}\n"))
        elif detail["type"] == "extra_forbidden" and len(detail["loc"]) == 1:
            name = str(detail["loc"][0])
            if name in stray[1:]:  # the keys of a part at the top are one mistake
                continue
            advice = advice_at_top(name, data[name], parts)
            if advice:
                fault = replace(fault, help=advice, fix=None)
        yield fault


_PART_KEYS = fields_of(Attachment).keys() - fields_of(Recipe).keys()
_OF_MJCF = {
    "worldbody": "write `add: [{to: world, body: {…}}]`",
    "include": "write `attach` for another model, or `base` for the one to start from",
    "flag": "write `option: {flag: {…}}`",
}


def part_keys(data: AbcMapping[str, Any]) -> dict[str, Any]:
    """Return the keys at the top of a recipe that only a part can have."""
    return {key: each for key, each in data.items() if key in _PART_KEYS and not isinstance(each, AbcMapping)}


def advice_at_top(name: str, value: Any, parts: AbcMapping[str, Any]) -> str | None:
    """Return what to write instead of `name: value` at the top, or None. `parts` are keys that only a part can have."""
    if isinstance(value, AbcMapping) and "model" in value and not closest(name, Recipe.model_fields):
        return f"a part goes under `attach`:\nattach:\n  {name}: {_flow(value)}"
    if name in parts and (len(parts) > 1 or name != "model"):
        entries = _flow({"model": "…", **parts})
        return f"{_keys_at_top(parts)} of a part under `attach`:\nattach:\n  PREFIX: {entries}"
    if name == "model":
        if isinstance(value, str) and (":" in value or value.lower().endswith((*MODEL_FILES, *MESH_FILES))):
            return f"write `base: {value}` for the model to start from, or put it under `attach`, in a part"
        return "write `base` for the model to start from, or `name` for the name of the result"
    return _OF_MJCF.get(name) or _in_section(name, value)


def _in_section(name: str, value: Any) -> str | None:
    """Return the section that has such an element or setting, or None."""
    if name in GRAMMAR.element("body").children:
        return f"write it in the list `add`: `add: [{{to: world, {name}: {_short(value)}}}]`"
    for tag, section in GRAMMAR.root.children.items():
        if tag in ("option", "visual", "statistic") and name in {*section.attributes, *section.children}:
            return f"write it in `{tag}`: `{tag}: {{{name}: {_short(value)}}}`"
        if tag in (*sections_of(ByTag), "contact") and name in section.children:
            return f"write it in the section `{tag}`: `{tag}: {{{name}: …}}`"
        if tag in sections_of(Typed) and name in section.children:
            return f"write it in the section `{tag}`: `{tag}: {{NAME: {{type: {name}, …}}}}`"
    return None


def _keys_at_top(parts: AbcMapping[str, Any]) -> str:
    *others, last = (f"`{key}`" for key in parts)
    return f"{', '.join(others)} and {last} are keys" if others else f"{last} is a key"


def _short(value: Any) -> str:
    items = value if isinstance(value, list) else [value]
    return value_text(value) if all(isinstance(each, str | int | float) for each in items) else "{…}"


def _flow(value: AbcMapping[str, Any]) -> str:
    return f"{{{', '.join(f'{key}: {_short(each)}' for key, each in value.items())}}}"


_UNKNOWN = ("unknown-key", "unknown-attribute", "unknown-element")
_SEVERAL = 4


def validate_what_remains(node: Node, sink: Sink, gone: Collection[Path] = ()) -> TrimmedRecipe | None:
    """Return the recipe without the pieces that have faults, or None if too little would remain. No I/O.

    `gone` are the paths of keys whose values have faults that are already reported. These keys do not count as missing.
    """
    if not isinstance(node, Mapping):
        help = "write `recipe: 1` as its first line, and the other keys below"
        message = f"a recipe is a mapping, got {kind_of(to_python(node))}"
        report([Fault("wrong-type", message, help=help)], node, sink)
        return None
    recipe, faults = judge(node)
    if recipe is not None:
        return TrimmedRecipe(recipe, node, frozenset())
    report((each for each in faults if not _follows(each, node, gone)), node, sink)
    return recover(node, faults, judge)


def judge(node: Mapping) -> tuple[Recipe | None, list[Fault]]:
    """Return the recipe of a located tree, or None and all of its faults."""
    early: list[Fault] = []
    data = raw(node, early)
    recipe = None
    found: list[Fault] = []
    most = in_force().faults
    try:
        recipe = Recipe.model_validate(data, context=Settings.of(data))
    except ValidationError as error:
        found = list(islice(faults(error, data), most + 1))
        if len(found) > most:  # each takes a search for a correction; the message says that there are too many
            return None, found
    emptied = {fault.at[:-1] for fault in early if fault.code == "expression" and fault.key}
    found = [fault for fault in found if not (fault.at in emptied and _is_emptied(data, fault))]
    found += faults_in_place(node, lambda model: judge(model)[1])
    if not early and not found:
        return recipe, []
    version = [fault for fault in found if fault.code == "recipe-version"]
    return None, version or list(_without_strangers(list(_without_misspelt(list(_one_each(early, found))))))


def _is_emptied(data: Any, fault: Fault) -> bool:
    """Whether a fault is about a mapping that is only empty because its keys have faults."""
    for step in fault.at:
        data = data[step]
    return fault.code == "wrong-type" and data == {}


def _follows(fault: Fault, node: Mapping, gone: Collection[Path]) -> bool:
    """Whether a fault is about a mapping that lacks a key only because the key is `gone`."""
    at = existing_steps(node, _mapping_of(fault))
    if fault.lacks is not None:
        return (*at, fault.lacks) in gone
    if all(each[:-1] != at for each in gone):
        return False
    mapping = find(node, at)
    is_empty = isinstance(mapping, Mapping) and not mapping.entries
    return fault.code == "missing-key" or (fault.code == "wrong-type" and is_empty)


def _one_each(early: list[Fault], found: list[Fault]) -> Iterable[Fault]:
    """Yield the faults to report.

    If a place has a fault of its own, the fault that its value is unexpected is omitted. Faults inside an unknown key,
    or inside a list where no list is expected, do not count.
    """
    unknown = {fault.at for fault in found if fault.key}
    unfit = {fault.at for fault in found if fault.code == "wrong-type"} - {fault.at for fault in early}
    outer = ({fault.at[:n] for n in range(1, len(fault.at))} for fault in early)
    kept = [
        each for each, above in zip(early, outer, strict=True) if not (above & unfit or {*above, each.at} & unknown)
    ]
    settled = {fault.at for fault in kept}
    yield from kept
    yield from (fault for fault in found if fault.key or fault.at not in settled)


def _without_misspelt(faults: list[Fault]) -> Iterator[Fault]:
    """Return the faults without those that a misspelled key causes twice, as an unknown and as a missing key."""
    lacking = {(_mapping_of(fault), fault.lacks): fault for fault in faults if fault.lacks is not None}
    keys_of: dict[Path, list[str]] = {}
    for at, key in lacking:
        keys_of.setdefault(at, []).append(str(key))
    corrected: list[Fault] = []
    for fault in faults:
        if lacking and fault.code in _UNKNOWN and fault.key:
            keys = [key for key in keys_of.get(fault.at[:-1], ()) if (fault.at[:-1], key) in lacking]
            near = closest(str(fault.at[-1]), keys)
            if near:
                del lacking[fault.at[:-1], near[0]]
                fault = replace(fault, help=f"write `{near[0]}`", fix=Fix(near[0], str(fault.at[-1])))
        corrected.append(fault)
    return (fault for fault in corrected if fault.lacks is None or (_mapping_of(fault), fault.lacks) in lacking)


def _mapping_of(fault: Fault) -> Path:
    return fault.at[:-1] if fault.beside else fault.at


def _without_strangers(faults: list[Fault]) -> Iterator[Fault]:
    """Yield the faults, with a single fault for a mapping that is of another kind or in a wrong place."""
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
            help = "is it in the right section? its indentation determines its section"
            yield replace(fault, notes=(note, *fault.notes), help=help, fix=None)
        elif fault is first and not (fault.code == "missing-key" and fault.at in several):
            yield fault
