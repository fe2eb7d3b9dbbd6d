"""Pydantic's errors become faults: the place, the fault, the expected value, the existing names, and the fix."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError
from pydantic.fields import FieldInfo

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Fix, Note, Path, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import advised, closest, exists_note, renaming
from mjcompose.base.words import value_text
from mjcompose.language.forms.context import Lazy, Rows
from mjcompose.language.forms.model import IT, KEY, OWNER, Model, fields_of, is_hidden, is_whole, rest_of, rows_of
from mjcompose.language.forms.scalars import Expects, Hints, Name, NumberUnit
from mjcompose.language.value import kind_of, without_space, without_unit
from mjcompose.text.node import Node, Scalar, find, locate

_UNIONS = (Union, UnionType)
_MAPPINGS = (dict, Mapping)
_LISTS = (list, tuple)
Mark = TypeVar("Mark")


class Spot(Struct):
    """A place of the language.

    `at` is its path in the recipe and `kind` the type of its value. `model` is the mapping with fixed keys around it,
    at `above`. `key` is the key in that mapping that leads to the value, and `info` is the declaration of that key.
    """

    at: Path
    kind: Any
    metadata: tuple[Any, ...] = ()
    model: type[BaseModel] | None = None
    above: Path = ()
    key: str | None = None
    info: FieldInfo | None = None

    def marked(self, kind: type[Mark]) -> Mark | None:
        """Return the annotation of a class that is nearest to the value, or None."""
        return next((each for each in reversed(self.metadata) if isinstance(each, kind)), None)


def _plain(kind: Any, *marks: Any) -> dict[str, Any]:
    """Return a type without `Annotated`, `Optional` and `Lazy`, and its annotations, as fields of a spot."""
    metadata = [*marks]
    while True:
        if get_origin(kind) is Annotated:
            kind, *more = get_args(kind)
            metadata += more
        elif get_origin(kind) in _UNIONS and type(None) in get_args(kind):
            left = tuple(each for each in get_args(kind) if each is not type(None))
            kind = left[0] if len(left) == 1 else Union[left]  # noqa: UP007
        elif lazy := next((each for each in metadata if isinstance(each, Lazy)), None):
            metadata.remove(lazy)
            kind = lazy.form
        else:
            return {"kind": kind, "metadata": tuple(metadata)}


def is_model(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Model)


def alternatives(kind: Any) -> tuple[Any, ...]:
    return get_args(kind) if get_origin(kind) in _UNIONS else ()


def spot(root: Any, loc: Path, data: Any, start: Path = ()) -> Spot:
    """Return the place to which pydantic's path leads, without steps that are not in `data`, which is at `start`."""
    found = Spot(start, **_plain(root))
    for index, step in enumerate(loc):
        is_end = index == len(loc) - 1
        below = _value_at(data, step)
        is_there = below is not _NOTHING or (is_end and isinstance(data, Mapping) and not is_hidden(step))
        found = _stepped(found, step, is_there)
        data = below if below is not _NOTHING else data
    return found


def _stepped(place: Spot, step: str | int, is_there: bool) -> Spot:
    at = (*place.at, step) if is_there else place.at
    kind = place.kind
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        info = fields_of(kind).get(str(step))
        if info is None:
            return Spot(at, Any, model=kind, above=place.at, key=str(step))
        found = _plain(info.annotation, *info.metadata)
        if is_hidden(step):
            return replace(place, **found, model=kind, above=place.at)
        return Spot(at, **found, model=kind, above=place.at, key=str(step), info=info)
    if (rows := place.marked(Rows)) is not None:
        return replace(place, **_plain(rows.form(str(step))), at=at, key=str(step), info=None)
    if is_hidden(step):
        tag = Tag(str(step))
        chosen = next((each for each in alternatives(kind) if tag in getattr(each, "__metadata__", ())), Any)
        return replace(place, **_plain(chosen, *place.metadata))
    return replace(place, **_plain(_inside(kind)), at=at)


_NOTHING = object()


def _value_at(data: Any, step: str | int) -> Any:
    if isinstance(data, Mapping):
        return data.get(step, _NOTHING)
    if isinstance(data, list) and isinstance(step, int) and step < len(data):
        return data[step]
    return _NOTHING


def inside(annotation: Any, depth: int) -> Any:
    """Return the type that an annotation contains at a depth, without `Annotated` and `Optional`."""
    kind = _plain(annotation)["kind"]
    return inside(_inside(kind), depth - 1) if depth else kind


def has_key(kind: Any, key: str) -> bool:
    return is_model(kind) and key in fields_of(kind)


def _inside(kind: Any) -> Any:
    arguments = get_args(kind) or (Any,)
    return arguments[1] if get_origin(kind) in _MAPPINGS and len(arguments) == 2 else arguments[0]


def spots(root: Any) -> Iterator[Spot]:
    """Yield every key that a type declares, at any depth; `*` stands for names and for indices."""
    yield from _below(Spot((), **_plain(root)), ())


def _below(place: Spot, around: tuple[Any, ...]) -> Iterator[Spot]:
    if members := alternatives(place.kind):
        for each in members:
            yield from _below(replace(place, **_plain(each, *place.metadata)), around)
        return
    if place.key is not None:
        yield place
    if isinstance(place.kind, type) and issubclass(place.kind, BaseModel):
        if place.kind in around:
            return  # a recipe in place
        for key, info in fields_of(place.kind).items():
            inner = [_stepped(place, key, not is_hidden(key))]
            if (rows := rows_of(info)) is not None:
                inner = [_stepped(inner[0], word, is_there=True) for word in rows.table().own]
            for each in inner:
                yield from _below(each, (*around, place.kind))
    elif get_origin(place.kind) in (*_MAPPINGS, *_LISTS):
        yield from _below(_stepped(place, "*", is_there=True), around)


def name_scopes(root: Any) -> dict[Path, Name]:
    names = ((each.at, each.marked(Name)) for each in spots(root))
    return {at: name for at, name in names if name is not None and name.scope}


def key_order(root: Any) -> dict[Path, list[str]]:
    """Return the keys of every mapping with fixed keys in the order in which `fmt` writes them.

    >>> from mjcompose.language.verbs.move import Move
    >>> key_order(Move)[("to",)]
    ['frame']
    """
    return {at: model.key_names() for at, model in _models(root) if not is_whole(model) and rest_of(model) is None}


def first_keys(root: Any) -> dict[Path, list[str]]:
    """Return the keys that `fmt` writes first in mappings whose other keys are in the order of the author."""
    found: dict[Path, list[str]] = {}
    for at, model in _models(root):
        if (rest := rest_of(model)) is not None:
            own = [*fields_of(model)]
            found[at] = [key for key in own[: own.index(rest)] if not is_hidden(key)]
    for key, info in fields_of(root).items():
        if first := next((mark.first for mark in info.metadata if hasattr(mark, "first")), ()):
            found[key, "*"] = [*first]
    return {at: keys for at, keys in found.items() if keys}


def _models(root: Any) -> Iterator[tuple[Path, type[Model]]]:
    if is_model(kind := inside(root, 0)):
        yield (), kind
    yield from ((each.at, each.kind) for each in spots(root) if is_model(each.kind))


_NOUNS = {
    "float_type": "a number",
    "finite_number": "a finite number",
    "int_type": "a whole number",
    "int_from_float": "a whole number",
    "bool_type": "`true` or `false`",
    "string_type": "text",
    "string_too_short": "text",
    "model_type": "a mapping",
    "dict_type": "a mapping",
    "mapping_type": "a mapping",
    "list_type": "a list",
    "tuple_type": "a list",
}
_BOUNDS = {
    "greater_than": ("gt", "more than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
# The meaning of `1cm`, `5g` or `2ms` is clear only for numbers in these units, and for plain numbers.
_PLAIN_UNITS = (None, "m", "kg", "s", "N")


def faults(error: ValidationError, root: Any, data: Any, start: Path = ()) -> Iterator[Fault]:
    """Yield a fault for each error of a validation of `data` as `root`, with paths from `start`, where the data are."""
    errors = error.errors(include_url=False)
    meant = {id(each) for each in misspelt(errors, root, data).values()}
    for each in errors:
        if id(each) not in meant:
            yield translated(each, root, data, start=start)


def report(faults: Iterable[Fault], node: Node, sink: Sink) -> None:
    """Report faults at their places in a tree."""
    for fault in faults:
        notes = (*fault.notes, *(Note(message, locate(node, at, key=True)) for message, at in fault.related))
        message = fault.message
        span = locate(node, fault.at, key=fault.key)
        if not fault.at:
            span = Span(span.file, span.line, span.column)
        if fault.within is not None:
            line, column, width = fault.within
            text = find(node, fault.at)
            if isinstance(text, Scalar) and text.block is not None:
                line = line + text.block[0] - 1
                column = column + text.block[1] - 1
                span = Span(span.file, line, column, end_line=line, end_column=column + width)
            else:
                message = f"line {line} of the fragment: {message}"
        sink.error(fault.code, message, span, notes=notes, help=fault.help, fix=fault.fix)


def misspelt(errors: Sequence[Any], root: Any, data: Any) -> dict[int, Any]:
    """Return the error of each missing key that an unknown key misspells, by the id of the unknown key's error."""
    missing: dict[Path, dict[str, Any]] = {}
    for each in errors:
        if each["type"] == "missing":
            missing.setdefault(each["loc"][:-1], {})[str(each["loc"][-1])] = each
    found: dict[int, Any] = {}
    for each in errors:
        beside = missing.get(each["loc"][:-1], {})
        if beside and each["type"] == "extra_forbidden":
            key = str(each["loc"][-1])
            around = spot(root, each["loc"], data).model
            right = around.instead.get(key) if is_model(around) else None  # type: ignore[union-attr]
            only = list(beside) if right is not None and len(beside) == 1 else None
            likely = [right] if right in beside else only or closest(key, list(beside))
            for near in likely:
                found[id(each)] = beside[near]
    return found


def translated(error: Any, root: Any, data: Any, start: Path = ()) -> Fault:
    """Return the fault for one error of pydantic's `errors()`."""
    kind = error["type"]
    loc = error["loc"]
    context = error.get("ctx", {})
    if kind == "fault":
        return _filled(context["fault"], root, loc, data=data, start=start)
    place = spot(root, loc, data, start=start)
    if kind == "missing":
        return _missing(place)
    if kind == "extra_forbidden":
        return _unknown(place)
    if kind == "literal_error":
        return _keyword(place, error["input"])
    if kind in _BOUNDS:
        bound, words = _BOUNDS[kind]
        message = f"{named(place)} is {value_text(error['input'])}, and must be {words} {context[bound]:g}"
        return Fault("out-of-range", message, place.at)
    if kind in ("too_short", "too_long"):
        return _length(place, error["input"], context)
    return _type(place, kind, error["input"], message=error["msg"])


def named(place: Spot) -> str:
    if is_model(place.kind):
        subject: str = place.kind.subject(place.at)
        return subject
    if isinstance(place.model, type) and issubclass(place.model, Model) and is_whole(place.model):
        return place.model.subject(place.above)
    if place.key is None:
        return f"`{place.at[-1]}`" if place.at else "the recipe"
    owner = _owner(place)
    name = f"`{place.key}`"
    if len(place.at) > len(place.above) + 1 and isinstance(place.at[-1], str):  # the entry of a mapping from names
        name = f"`{place.at[-1]}` in {name}"
    return f"{name} of {owner}" if owner not in ("", name) else name


def _owner(place: Spot) -> str:
    ours = isinstance(place.model, type) and issubclass(place.model, Model)
    return place.model.owner(place.above) if ours else ""  # type: ignore[union-attr]


def _filled(fault: Fault, root: Any, loc: Path, data: Any, start: Path) -> Fault:
    above = loc[: len(loc) - len(fault.at)]
    place = spot(root, above, data, start=start)
    own = place.kind.owner(place.at) if is_model(place.kind) else _owner(place)
    names = {IT: named(place), OWNER: own or named(place), KEY: str(place.key or "")}

    def fill(text: str) -> str:
        for mark, name in names.items():
            text = text.replace(mark, name)
        return text

    related = tuple((fill(text), spot(root, (*above, *at), data, start=start).at) for text, at in fault.related)
    at = spot(root, loc, data, start=start).at
    help = fault.help and fill(fault.help)
    return replace(fault, message=fill(fault.message), at=at, help=help, related=related)


def _missing(place: Spot) -> Fault:
    assert place.model is not None
    unit = place.marked(NumberUnit)
    help = f"write `{place.key}: {_example(place) or '…'}`" + (f", in {unit.name}" if unit else "")
    message = f"{_subject(place)} lacks `{place.key}`"
    return Fault("missing-key", message, place.above, key=True, help=help, lacks=place.key)


def _subject(place: Spot) -> str:
    model = place.model
    return model.subject(place.above) if model is not None and issubclass(model, Model) else f"`{place.above[-1]}`"


def _unknown(place: Spot) -> Fault:
    model = place.model
    key = str(place.key)
    assert model is not None and issubclass(model, Model)
    message = f"{_subject(place)} has no {model.noun} `{key}`"
    help, fix = advised(key, model.listed())
    if (instead := model.instead.get(key)) is not None:
        is_key = instead in model.key_names()
        help = f"write `{instead}`" if is_key else instead
        fix = Fix(instead, key) if is_key else None
    notes = (exists_note(model.noun, model.listed(), key),)
    return Fault("unknown-key", message, place.at, key=True, notes=notes, help=help, fix=fix)


def _keyword(place: Spot, value: Any) -> Fault:
    words = [value_text(each) for each in get_args(place.kind)]
    name = named(place)
    if not isinstance(value, str):
        quoted = [f"`{each}`" for each in words]
        what = " or ".join(quoted) if len(quoted) < 3 else "a keyword"
        listed = f"write one of {', '.join(quoted)}" if len(quoted) > 2 else None
        return Fault("wrong-type", f"{name} expects {what}, got {kind_of(value)}", place.at, help=listed)
    near = closest(value, words) or [each for each in words if len(value) > 1 and each.startswith(value)]
    key = "" if isinstance(place.at[-1], int) else f"{place.key}: "
    help: str | None = f"write `{key}{near[0]}`" if near else None
    fix = renaming(value, words)
    elsewhere = place.marked(Hints)
    if elsewhere is not None and value in elsewhere.elsewhere:
        help = elsewhere.elsewhere[value]
        fix = None
        if help in words:
            fix = Fix(help, value)
            help = f"write `{key}{help}`"
    note = exists_note("keyword", words, value)
    return Fault("wrong-keyword", f"{name} cannot be `{value}`", place.at, notes=(note,), help=help, fix=fix)


def _length(place: Spot, value: Any, context: Mapping[str, Any]) -> Fault:
    expects = place.marked(Expects)
    bound = ("at least", context["min_length"]) if "min_length" in context else ("at most", context["max_length"])
    what = expects.what if expects else f"{bound[0]} {bound[1]}"
    example = _example(place)
    help = f"write for instance `{place.key}: {example}`" if example else None
    if not value:
        got = "an empty list" if isinstance(value, list) else "an empty mapping"
        return Fault("wrong-type", f"{named(place)} expects {what}, got {got}", place.at, help=help)
    return Fault("wrong-length", f"{named(place)} expects {what}, got {len(value)}", place.at, help=help)


def _type(place: Spot, kind: str, value: Any, message: str) -> Fault:
    expects = place.marked(Expects)
    name = place.marked(Name)
    noun = _NOUNS.get(kind)
    if noun is None:
        return Fault("wrong-type", f"{named(place)}: {message[:1].lower()}{message[1:]}", place.at)
    if kind != "finite_number":
        noun = expects.what if expects else name.what if name else noun
    got = "nothing" if value == "" else "an empty one" if value == {} else kind_of(value)
    help, fix = _advice(place, value)
    if kind in ("list_type", "tuple_type") and place.key in place.at[-1:]:
        help = _as_list(place, value) or help
    if kind == "string_type" and isinstance(value, int | float) and help is None:
        help = f"quote it: '{value_text(value)}'"
    return Fault("wrong-type", f"{named(place)} expects {noun}, got {got}", place.at, help=help, fix=fix)


def _as_list(place: Spot, value: Any) -> str | None:
    """Return the list to write instead of a single value, or None if the value is not an item of the list."""
    item = inside(place.kind, 1)
    if is_model(item) and isinstance(value, dict):
        first = next((key for key in value if key in item.key_names()), None)
        return f"put `- ` in front of `{first}`" if first is not None else None
    is_word = item is str or get_origin(item) is Literal
    return f"write `{place.key}: [{value}]`" if is_word and isinstance(value, str) and value else None


def _advice(place: Spot, value: Any) -> tuple[str | None, Fix | None]:
    """Return an example to write instead of a value of the wrong type."""
    if is_model(place.kind):
        if isinstance(value, str) and (spaced := without_space(value, place.kind.key_names())):
            return f"put a space after the colon: `{spaced}`", None
        if place.kind.example:
            example = place.kind.example.replace("…", value if isinstance(value, str) else "…")
            key = f"{place.at[-1]}: " if place.at and isinstance(place.at[-1], str) else ""
            return f"write `{key}{example}`", None
        return None, None
    unit = place.marked(NumberUnit)
    if isinstance(value, str) and place.kind in (float, int) and (unit.name if unit else None) in _PLAIN_UNITS:
        advice = without_unit(value)
        return (advice.help, advice.fix) if advice is not None else (None, None)
    example = _example(place)
    return (f"write for instance `{place.key}: {example}`" if example and place.kind is not float else None), None


def _example(place: Spot) -> str | None:
    if place.info is not None and place.info.examples:
        return str(place.info.examples[0])
    expects = place.marked(Expects)
    return expects.example if expects else None
