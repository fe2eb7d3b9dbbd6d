"""The section `add`: elements under a body, a frame or the world."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

from composer.dataclass import dataclass
from composer.diagnostics.suggest import advised, exists_note
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType
from composer.recipe.element import Element
from composer.recipe.element_schema import mapping
from composer.recipe.fault import EXCLUSIVE, Fault, Path
from composer.recipe.form import Form
from composer.recipe.presence import missing_key
from composer.recipe.raw import path_of
from composer.recipe.reader import FRAGMENT, Reader, label
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.settings import Settings
from composer.recipe.shown import kind_of
from composer.recipe.text import is_unprintable, unprintable

TO = "to"
ID = "id"
WORLD = "world"
Target = tuple[Literal["world", "body", "frame"], str]


@dataclass(frozen=True, slots=True)
class Addition:
    """One entry of `add`: an element, and where it is added.

    `to` is the name of a body or frame, or `world`. The place of the name is `locate(node, (*at, "to"))`, and for a
    frame `locate(node, (*at, "to", "frame"))`.
    """

    to_kind: Literal["world", "body", "frame"]
    to: str
    element: Element
    at: Path = ()


@dataclass(frozen=True, slots=True)
class Additions(Form):
    """Form of the field `add`: a list of `{to: NAME, TAG: {…}}`, read as a tuple of `Addition`."""

    def schema(self) -> Schema:
        return {"type": "array", "items": reference("addition")}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> tuple[Addition, ...]:
        reader = Reader(settings, faults)
        additions: list[Addition | None] = []
        if isinstance(value, list):
            additions = [_addition(reader, item, (index,)) for index, item in enumerate(value)]
        else:
            help = f"put `- ` in front of `{TO}`" if isinstance(value, dict) and TO in value else None
            message = f"`add` expects a list of entries, got {kind_of(value)}"
            faults.append(Fault("wrong-type", message, help=help))
        return tuple(each for each in additions if each is not None)


def addable(place: str) -> Mapping[str, ElementType]:
    """Return the elements that can be added to the world, a body or a frame."""
    return GRAMMAR.element("worldbody" if place == WORLD else place).children


def _addition(reader: Reader, value: Any, at: Path) -> Addition | None:
    if not isinstance(value, dict):
        message = f"an entry of `add` is a mapping, got {kind_of(value)}"
        reader.faults.append(Fault("wrong-type", message, at, help="write `{to: NAME, TAG: {…}}`"))
        return None
    target: Target | None = None
    if TO in value:
        target = _target(reader, value[TO], (*at, TO))
    else:
        fault = missing_key("an entry of `add`", TO, at)
        help = "write `to: world`, or the name of a body"
        reader.faults.append(replace(fault, key=False, help=help))
    kinds = addable(target[0] if target else "body")
    element = _element(
        reader, value, at, kinds=kinds, place="the world" if target and target[0] == WORLD else "`add`"
    )
    if target is None or element is None:
        return None
    return Addition(target[0], target[1], element, at=path_of(value))


def _element(
    reader: Reader, value: dict[str, Any], at: Path, kinds: Mapping[str, ElementType], place: str
) -> Element | None:
    """Return the one element of an entry, or None after a reported fault."""
    found = [name for name in value if name in kinds or name == FRAGMENT]
    for name in value:
        if name != TO and name not in found:
            reader.faults.append(_unknown(name, (*at, name), kinds, place=place))
    if not found:
        if set(value) <= {TO}:
            help = "write the element as `TAG: {…}`, for instance `site: {name: tcp, pos: [0, 0, 0.1]}`"
            reader.faults.append(Fault("missing-key", "an entry of `add` has no element", at, help=help))
        return None
    first, *others = found
    for name in others:
        reader.faults.append(
            Fault(
                EXCLUSIVE,
                f"an entry of `add` has both `{first}` and `{name}`, of which only one may stand",
                (*at, name),
                key=True,
                related=((f"`{first}` is written here", (*at, first)),),
                help=f"write an entry of its own for `{name}`",
            )
        )
    if first == FRAGMENT:
        return reader.fragment(kinds, place, value, at=at, own=(TO, *others))
    item = value[first]
    if isinstance(item, list):
        help = f"write an entry of its own for each `{first}`"
        message = f"an entry of `add` has one `{first}`, got a list"
        reader.faults.append(Fault("wrong-type", message, (*at, first), help=help))
        return None
    return reader.element(kinds[first], item, (*at, first), label(first, item))


def _unknown(name: str, at: Path, kinds: Mapping[str, ElementType], place: str) -> Fault:
    if name in addable("body"):
        message = f"`{name}` cannot stand in {place}, only in a body"
        return Fault("unknown-element", message, at, key=True)
    help, fix = advised(name, [*kinds, TO])
    note = exists_note("element", kinds, name)
    if name in GRAMMAR.root.children:
        help, fix = f"write it in the section `{name}`", None
    return Fault(
        "unknown-element",
        f"`{name}` is not an element that can be added",
        at,
        key=True,
        notes=(note,),
        help=help,
        fix=fix,
    )


def _target(reader: Reader, value: Any, at: Path) -> Target | None:
    """Return where an element is added: a name, `world`, or `{frame: NAME}`."""
    kind: Literal["body", "frame"] = "body"
    if isinstance(value, dict) and list(value) == ["frame"]:
        kind, value, at = "frame", value["frame"], (*at, "frame")
    if not isinstance(value, str) or not value:
        help = "write the name of a body, `world`, or `{frame: NAME}`"
        message = f"`{TO}` expects a name, got {kind_of(value) if value != '' else 'empty text'}"
        reader.faults.append(Fault("wrong-type", message, at, help=help))
        return None
    if is_unprintable(value):
        reader.faults.append(unprintable(f"`{TO}`", at))
        return None
    if kind == "body" and value == WORLD:
        return "world", WORLD
    return kind, value


@definition("addition")
def _definition_of_addition(_: str) -> Schema:
    frame = {
        **mapping({"frame": {"type": "string", "minLength": 1, "description": "the name of a frame"}}),
        "required": ["frame"],
    }
    target: Schema = {
        "anyOf": [{"type": "string", "minLength": 1}, frame],
        "description": "the name of a body, `world`, or `{frame: NAME}`",
    }
    elements = {
        tag: reference(f"element:{kind.path}") for tag, kind in GRAMMAR.element("body").children.items()
    }
    schema = mapping({"to": target, **elements, FRAGMENT: reference("fragment")})
    return {**schema, "required": ["to"], "minProperties": 2, "maxProperties": 2}
