"""Write `mjcf/elements.pyi`, which tells type checkers the attributes and children of every element."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from mjcompose import mjcf
from mjcompose.mjcf.attributed import always_there, class_name, kinds
from mjcompose.mjcf.element import Element, RootElement
from mjcompose.tree.grammar import GRAMMAR, Attribute, ElementType
from mjcompose.tree.select import query, spoken

_WIDTH = 140
_HEAD = '''\
# Written from the grammar by `make schemas`; do not edit.
# mypy: disable-error-code="override,misc"
# pyright: reportIncompatibleMethodOverride=false, reportIncompatibleVariableOverride=false
import os
from typing import Any, Generic, Literal, Never, TypedDict, TypeAlias, TypeVar, Unpack, overload

from numpy import float64, int64
from numpy.typing import ArrayLike, NDArray

from .asset import Asset as _Asset
from .element import Element, ElementList

_R = TypeVar("_R")
_W = TypeVar("_W")

class _Attribute(Generic[_R, _W]):
    """An attribute that gives `_R` and takes `_W`. It may be None where it is not set; checkers let that pass."""

    def __get__(self, instance: object, owner: Any = None) -> _R | Any: ...
    def __set__(self, instance: object, value: _W | None) -> None: ...
    def __delete__(self, instance: object) -> None: ...

_InFloats: TypeAlias = ArrayLike | None
_InInts: TypeAlias = ArrayLike | None
_InFloat: TypeAlias = float | str | None
_InInt: TypeAlias = int | str | None
_InBool: TypeAlias = bool | Literal["true", "false"] | None
_InText: TypeAlias = str | None
_InWords: TypeAlias = str | list[str] | tuple[str, ...] | None
_InFile: TypeAlias = str | os.PathLike[str] | _Asset | None
_InElement: TypeAlias = Element | str | None
_InElements: TypeAlias = _InElement | list[Element | str] | list[Element] | list[str] | tuple[Element | str, ...]
_Floats: TypeAlias = _Attribute[NDArray[float64], ArrayLike]
_Ints: TypeAlias = _Attribute[NDArray[int64], ArrayLike]
_Float: TypeAlias = _Attribute[float64, float | str]
_Int: TypeAlias = _Attribute[int64, int | str]
_Bool: TypeAlias = _Attribute[bool, _InBool]
_Text: TypeAlias = _Attribute[str, str]
_Words: TypeAlias = _Attribute[list[str], _InWords]
_File: TypeAlias = _Attribute[_Asset, _InFile]
_Element: TypeAlias = _Attribute[Element, _InElement]
_Elements: TypeAlias = _Attribute[list[Element], _InElements]

class AnyElement(Element):
    """An element of a kind that is known only when the program runs."""

    def __getattr__(self, name: str) -> Any: ...
    def __setattr__(self, name: str, value: object) -> None: ...
'''


def stub() -> str:
    """Return the text of `elements.pyi`."""
    return "\n".join(_lines()) + "\n"


def _lines() -> Iterator[str]:
    every = kinds()
    yield _HEAD
    words = _word_lists([GRAMMAR.root, *every.values()])
    for allowed, name in words.items():
        listed = ", ".join(f'"{word}"' for word in allowed)
        yield f"{name}: TypeAlias = Literal[{listed}]"
    yield ""
    yield from _finding()
    values: dict[tuple[str, ...], str] = {}
    for name, kind in every.items():
        given = _given(kind, words)
        if given not in values:
            values[given] = f"_{name}Values"
            yield f"class {values[given]}(TypedDict, total=False):"
            yield from _packed(given)
    named = {kind.path: values[_given(kind, words)] for kind in every.values()}
    alike: dict[tuple[str, ...], list[str]] = {}
    for name, kind in [*every.items(), ("Mujoco", GRAMMAR.root)]:
        alike.setdefault(tuple(_members(kind, words, values=named)), []).append(name)
    for members, classes in alike.items():
        base = "Known" if len(classes) == 1 else f"_Like{classes[0]}"
        if len(classes) > 1:
            yield from (f"class {base}(Known):", *members, "")
            members = ("    ...",)
        for name in classes:
            yield from (f"class {name}({base}):", *members, "")


def _word_lists(every: Iterable[ElementType]) -> dict[tuple[str, ...], str]:
    """Return a name for each list of keywords: the name of the first attribute that has it."""
    found: dict[tuple[str, ...], str] = {}
    for kind in every:
        for attribute in kind.attributes.values():
            if attribute.type == "keyword" and attribute.keywords not in found:
                name = f"_{class_name(kind)}{attribute.name.capitalize()}"
                found[attribute.keywords] = name
    return found


def _finding() -> Iterator[str]:
    """Yield the class of all elements of a known kind, whose `find` knows the kinds that each tag selects."""
    tags = sorted({kind.tag for kind in kinds().values()} | GRAMMAR.families.keys())
    yield "class Known(Element):"
    for method, wide, rest in (
        ("find", "{} | None", "name: str | None = None"),
        ("find_all", "list[{}]", "immediate_children_only: bool = False, exclude_attachments: bool = False"),
    ):
        for tag in tags:
            kind = _only_kind(tag)
            if kind is not None:
                yield "    @overload"
                yield f'    def {method}(self, tag: Literal["{tag}"], {rest}) -> {wide.format(kind)}: ...'
        yield "    @overload"
        yield f"    def {method}(self, tag: str, {rest}) -> {wide.format('AnyElement')}: ..."
    yield ""


def _only_kind(tag: str) -> str | None:
    """Return the class that a tag selects from the root, if it is a single class; `joint` is taken for a joint."""
    paths = query(tag, None).paths
    found = {"joint"} if tag == "joint" else paths
    return class_name(GRAMMAR.element(next(iter(found)))) if len(found) == 1 else None


def _given(kind: ElementType, words: dict[tuple[str, ...], str]) -> tuple[str, ...]:
    """Return the attributes that `add` takes, with their types; elements with the same ones share a class."""
    return tuple(f"{spoken(each.name)}: {_type(each, words, 'In')}" for each in kind.attributes.values())


def _members(kind: ElementType, words: dict[tuple[str, ...], str], values: dict[str, str]) -> Iterator[str]:
    """Yield the body of the class of an element: its children, its attributes, and its methods that add elements."""
    attributes = {spoken(each.name): each for each in kind.attributes.values()}
    taken = dir(RootElement if kind is GRAMMAR.root else Element)
    held = [f"{each}: {_child(kind, child)}" for each, child in _children(kind) if each not in taken]
    held += [f"{each}: {_type(attribute, words, '')}" for each, attribute in attributes.items() if each not in taken]
    yield from _packed(held)
    if kind.path in values:
        yield f"    def set_attributes(self, **attributes: Unpack[{values[kind.path]}]) -> None: ..."
    tags = list(kind.children)
    for tag in tags:
        if len(tags) > 1:
            yield "    @overload"
        child = class_name(kind.children[tag])
        unpacked = f"**attributes: Unpack[{values[kind.children[tag].path]}]"
        yield f'    def add(self, tag: Literal["{tag}"], /, {unpacked}) -> {child}: ...'
    listed = ", ".join(f'"{tag}"' for tag in tags)
    only = f"Literal[{listed}]" if tags else "Never"
    yield f"    def insert(self, tag: {only}, /, position: int, **attributes: object) -> AnyElement: ..."
    if not tags:
        yield "    def add(self, tag: Never, /) -> Never: ..."


def _packed(statements: Iterable[str]) -> Iterator[str]:
    """Yield short statements, several in a line."""
    line = ""
    for each in statements:
        if line and len(line) + len(each) + 6 > _WIDTH:
            yield f"    {line}"
            line = ""
        line = f"{line}; {each}" if line else each
    yield f"    {line or '...'}"


def _children(kind: ElementType) -> Iterator[tuple[str, ElementType]]:
    attributes = {spoken(name) for name in kind.attributes}
    return ((spoken(tag), child) for tag, child in kind.children.items() if spoken(tag) not in attributes)


def _child(kind: ElementType, child: ElementType) -> str:
    if always_there(kind, child):
        return class_name(child)
    return f"{class_name(child)} | Any" if child.max_count == 1 else f"ElementList[{class_name(child)}]"


def _type(attribute: Attribute, words: dict[tuple[str, ...], str], way: str) -> str:
    """Return the type of an attribute, as it is read or (`In`) given."""
    if attribute.type == "keyword":
        allowed = words[attribute.keywords]
        if {"true", "false"} & {*attribute.keywords}:
            allowed += " | bool"
        return f"{allowed} | None" if way else f"_Attribute[str, {allowed}]"
    if attribute.is_number:
        what = "Float" if attribute.type == "real" else "Int"
        return f"_{way}{what}" + ("" if attribute.max_length == 1 else "s")
    names = {"bool": "Bool", "keywords": "Words", "file": "File", "reference": "Element"}
    return f"_{way}{'Elements' if attribute.type == 'references' else names.get(attribute.type, 'Text')}"


if __name__ == "__main__":
    Path(mjcf.__file__).with_name("elements.pyi").write_text(stub(), encoding="utf-8")
