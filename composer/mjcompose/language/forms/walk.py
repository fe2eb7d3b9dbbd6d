"""The declarations of the models at a path of a recipe: for messages, for editors, and for the order of keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from types import UnionType
from typing import Annotated, Any, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, Tag
from pydantic.fields import FieldInfo

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.forms.context import Lazy, Rows
from mjcompose.language.forms.model import WHOLE, Model, fields_of, is_hidden, rest_of, rows_of
from mjcompose.language.forms.scalars import Name

_UNIONS = (Union, UnionType)
_MAPPINGS = (dict, Mapping)
_LISTS = (list, tuple)
Mark = TypeVar("Mark")


@dataclass(frozen=True, slots=True)
class Spot:
    """A place of the language.

    `at` is its path in the recipe and `kind` the type of its value. `model` is the mapping with fixed keys around it,
    at `above`, `key` the key there on the way to the value, and `info` the declaration of that key.
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


@dataclass(slots=True)
class _Way:
    """The state of a walk: the type at its end, and its annotations."""

    kind: Any
    metadata: list[Any] = field(default_factory=list)

    def plain(self) -> _Way:
        """Take off `Annotated`, `Optional` and `Lazy`."""
        while True:
            if get_origin(self.kind) is Annotated:
                self.kind, *more = get_args(self.kind)
                self.metadata += more
            elif get_origin(self.kind) in _UNIONS and type(None) in get_args(self.kind):
                left = tuple(each for each in get_args(self.kind) if each is not type(None))
                self.kind = left[0] if len(left) == 1 else Union[left]  # noqa: UP007
            elif lazy := next((each for each in self.metadata if isinstance(each, Lazy)), None):
                self.metadata.remove(lazy)
                self.kind = lazy.form
            else:
                return self


def is_model(kind: Any) -> bool:
    """Return whether a type is a mapping with fixed keys of this framework."""
    return isinstance(kind, type) and issubclass(kind, Model)


def alternatives(kind: Any) -> tuple[Any, ...]:
    """Return the members of a union, or none."""
    return get_args(kind) if get_origin(kind) in _UNIONS else ()


def spot(root: Any, loc: Path, data: Any, start: Path = ()) -> Spot:
    """Return the place to which pydantic's path leads. `start` is the path of `data`, whose type is `root`.

    The path omits steps that are not in the data, except for a missing key.
    """
    way = _Way(root).plain()
    found = Spot(start, way.kind, tuple(way.metadata))
    for index, step in enumerate(loc):
        is_end = index == len(loc) - 1
        below = _value_at(data, step)
        is_there = below is not _NOTHING or (is_end and isinstance(data, Mapping) and not is_hidden(step))
        found = _stepped(found, step, is_there)
        data = below if below is not _NOTHING else data
    return found


def _stepped(place: Spot, step: str | int, is_there: bool) -> Spot:
    at = (*place.at, step) if is_there else place.at
    kind, marks = place.kind, list(place.metadata)
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        info = fields_of(kind).get(str(step))
        if info is None:
            return Spot(at, Any, model=kind, above=place.at, key=str(step))
        way = _Way(info.annotation, [*info.metadata]).plain()
        if step == WHOLE:
            return replace(place, kind=way.kind, metadata=tuple(way.metadata), model=kind, above=place.at)
        if is_hidden(step):
            return replace(place, kind=way.kind, metadata=tuple(way.metadata), model=kind, above=place.at)
        return Spot(at, way.kind, tuple(way.metadata), model=kind, above=place.at, key=str(step), info=info)
    rows = next((each for each in marks if isinstance(each, Rows)), None)
    if rows is not None:
        way = _Way(rows.form(str(step))).plain()
        return replace(place, at=at, kind=way.kind, metadata=tuple(way.metadata), key=str(step), info=None)
    if is_hidden(step):
        tagged = [each for each in alternatives(kind) if Tag(str(step)) in getattr(each, "__metadata__", ())]
        way = _Way(tagged[0] if tagged else Any).plain()
        return replace(place, kind=way.kind, metadata=(*marks, *way.metadata))
    way = _Way(_inside(kind)).plain()
    return replace(place, at=at, kind=way.kind, metadata=tuple(way.metadata))


_NOTHING = object()


def _value_at(data: Any, step: str | int) -> Any:
    if isinstance(data, Mapping):
        return data.get(step, _NOTHING)
    if isinstance(data, list) and isinstance(step, int) and step < len(data):
        return data[step]
    return _NOTHING


def inside(annotation: Any, depth: int) -> Any:
    """Return the type that an annotation contains at a depth, without `Annotated` and `Optional`."""
    kind = _Way(annotation).plain().kind
    return inside(_inside(kind), depth - 1) if depth else kind


def has_key(kind: Any, key: str) -> bool:
    """Return whether a type is a mapping with a key."""
    return is_model(kind) and key in fields_of(kind)


def _inside(kind: Any) -> Any:
    """Return the type of the items of a list, or of the values of a mapping from names."""
    arguments = get_args(kind) or (Any,)
    return arguments[1] if get_origin(kind) in _MAPPINGS and len(arguments) == 2 else arguments[0]


def spots(root: Any, at: Path = ()) -> Iterator[Spot]:
    """Yield every key that a type declares, at any depth; `*` stands for names and for indices."""
    way = _Way(root).plain()
    yield from _below(Spot(at, way.kind, tuple(way.metadata)), ())


def _below(place: Spot, around: tuple[Any, ...]) -> Iterator[Spot]:
    if members := alternatives(place.kind):
        for each in members:
            way = _Way(each, [*place.metadata]).plain()
            yield from _below(replace(place, kind=way.kind, metadata=tuple(way.metadata)), around)
        return
    if place.key is not None:
        yield place
    if isinstance(place.kind, type) and issubclass(place.kind, BaseModel):
        if place.kind in around:
            return  # a recipe in place
        for key, info in fields_of(place.kind).items():
            if (rows := rows_of(info)) is not None:
                for word in rows.table().own:
                    below = _Way(rows.form(word)).plain()
                    inner = Spot(
                        (*place.at, word), below.kind, tuple(below.metadata), model=place.kind, above=place.at, key=word
                    )
                    yield from _below(inner, (*around, place.kind))
                continue
            inner = _stepped(place, key, not is_hidden(key))
            yield from _below(inner, (*around, place.kind))
    elif get_origin(place.kind) in (*_MAPPINGS, *_LISTS):
        yield from _below(_stepped(place, "*", is_there=True), around)


def name_scopes(root: Any) -> dict[Path, Name]:
    """Return which names may be written where, for the completion of editors."""
    names = ((each.at, each.marked(Name)) for each in spots(root))
    return {at: name for at, name in names if name is not None and name.scope}


def key_order(root: Any) -> dict[Path, list[str]]:
    """Return the keys of every mapping with fixed keys in the order in which `fmt` writes them.

    >>> from mjcompose.build.verbs.move import Move
    >>> key_order(Move)[("to",)]
    ['frame']
    """
    return {
        at: model.key_names() for at, model in _models(root) if WHOLE not in fields_of(model) and rest_of(model) is None
    }


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
    way = _Way(root).plain()
    if is_model(way.kind):
        yield (), way.kind
    yield from ((each.at, each.kind) for each in spots(root) if is_model(each.kind))
