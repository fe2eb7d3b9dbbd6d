"""The forms of the language at a place of a recipe, found by following a path through the JSON Schema of recipes."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

from mjcompose.base.dataclass import Struct
from mjcompose.language.schema import recipe_schema
from mjcompose.lsp.cursor import Path
from mjcompose.tree.grammar import GRAMMAR, ElementType

Schema = dict[str, Any]
_ELEMENT = re.compile(r"(?:element|named|variant|settable|scalable)\.(.+)")
_TYPES: dict[str, tuple[type, ...]] = {
    "object": (dict,),
    "array": (list,),
    "string": (str,),
    "boolean": (bool,),
    "number": (int, float),
    "integer": (int,),
}
_MOST = 400  # the most schemas for one place: they refer to one another


@cache
def whole() -> Schema:
    return recipe_schema()


class ValueForm(Struct):
    """One way to write a value. `role` is its name in the schema, such as `element.geom`."""

    schema: Schema
    role: str = ""

    @property
    def doc(self) -> str:
        return str(self.schema.get("markdownDescription") or self.schema.get("description") or "")


class KeySyntax(Struct):
    name: str
    doc: str
    forms: tuple[ValueForm, ...]
    required: bool = False


def forms_at(path: Path, data: Any = None) -> list[ValueForm]:
    """Return the ways in which the value at a path can be written, in a recipe with this data."""
    forms = list(_spread(ValueForm(whole()), data))
    for step in path:
        data = _inside(data, step)
        forms = forms_below(forms, step, data)
    return forms


def forms_below(forms: list[ValueForm], step: str | int, data: Any) -> list[ValueForm]:
    """Return the ways in which a value inside one of these forms can be written. `data` is the outer value."""
    below = [found for form in forms for found in _step(form, step)]
    return [each for found in below for each in _spread(found, data)]


def keys_of(forms: list[ValueForm]) -> list[KeySyntax]:
    """Return the keys that a mapping of these forms can have, in the order of the language."""
    found: dict[str, KeySyntax] = {}
    required = {name for form in forms for name in form.schema.get("required", ())}
    for form in forms:
        for name, schema in form.schema.get("properties", {}).items():
            if schema is not False and (name not in found or not found[name].doc):
                inner = list(_spread(ValueForm(schema), None))
                doc = ValueForm(schema).doc or next((each.doc for each in inner if each.doc), "")
                found[name] = KeySyntax(name, doc, tuple(inner), name in required)
        for name in form.schema.get("propertyNames", {}).get("enum", ()):
            found.setdefault(name, KeySyntax(name, "", ()))
    return list(found.values())


def words_of(forms: list[ValueForm]) -> dict[str, str]:
    found: dict[str, str] = {}
    for form in forms:
        schema = form.schema
        docs = schema.get("markdownEnumDescriptions") or schema.get("enumDescriptions") or []
        for at, word in enumerate(schema.get("enum", [schema["const"]] if "const" in schema else [])):
            if word is not None:
                text = str(word).lower() if isinstance(word, bool) else str(word)
                found.setdefault(text, docs[at] if at < len(docs) else form.doc)
        if schema.get("type") == "boolean" or form.role.endswith("boolean"):
            found.setdefault("true", "")
            found.setdefault("false", "")
    return found


def doc_of(path: Path, data: Any = None) -> str:
    for key in keys_of(forms_at(path[:-1], data)):
        if key.name == path[-1]:
            return key.doc
    return next((form.doc for form in forms_at(path, data) if form.doc), "")


def kinds_of(forms: list[ValueForm]) -> list[ElementType]:
    found: dict[str, ElementType] = {}
    for form in forms:
        match = _ELEMENT.fullmatch(form.role)
        path = "" if match is None else match[1].replace(".", "/")
        if path in GRAMMAR.paths:
            found[path] = GRAMMAR.element(path)
    return list(found.values())


def _inside(data: Any, step: str | int) -> Any:
    try:
        return data[step] if isinstance(data, dict | list) else None  # type: ignore[index]
    except (LookupError, TypeError):
        return None


def _step(form: ValueForm, step: str | int) -> Iterator[ValueForm]:
    schema = form.schema
    if isinstance(step, int):
        items = schema.get("items")
        if isinstance(items, dict):
            yield ValueForm(items)
        return
    found = schema.get("properties", {}).get(step)
    if isinstance(found, dict):
        yield ValueForm(found, f"{form.role}@{step}" if form.role else "")  # an attribute has no name of its own
        return
    for pattern, found in schema.get("patternProperties", {}).items():
        if re.search(pattern, step):
            yield ValueForm(found)
    found = schema.get("additionalProperties")
    if isinstance(found, dict):
        yield ValueForm(found)


def _spread(form: ValueForm, data: Any) -> Iterator[ValueForm]:
    """Yield a form and everything that it refers to, without the alternatives that the data excludes."""
    waiting = [form]
    count = 0
    while waiting and count < _MOST:
        current = waiting.pop(0)
        count = count + 1
        yield current
        target = current.schema.get("$ref")
        if target is not None:
            name = target.removeprefix("#/$defs/")
            plain = name.removeprefix("piece.")
            kept = current.role if "@" in current.role and not _ELEMENT.fullmatch(plain) else plain
            waiting.append(ValueForm(whole()["$defs"][name], kept or plain))
        waiting += [ValueForm(schema, current.role) for schema in _parts_of(current.schema, data)]


def _parts_of(schema: Schema, data: Any) -> Iterator[Schema]:
    """Yield the schemas of the same place that a schema is made of, without those that the data excludes."""
    yield from schema.get("allOf", ())
    for branch in schema.get("anyOf", ()):
        if data is None or "type" not in branch or _is_type(branch["type"], data):
            yield branch
    condition = schema.get("if")
    if condition is not None:
        holds = None if data is None else _holds(condition, data)
        for word, outcome in (("then", True), ("else", False)):
            if word in schema and (holds is None or holds is outcome):
                yield schema[word]


def _is_type(types: str | list[str], data: Any) -> bool:
    return any(isinstance(data, _TYPES.get(each, ())) for each in ([types] if isinstance(types, str) else types))


def _holds(condition: Schema, data: Any) -> bool:
    """Return whether the data fulfills the condition of an `if`. The schema has three kinds of conditions."""
    if "type" in condition and not _is_type(condition["type"], data):
        return False
    if data != condition.get("const", data) or data not in condition.get("enum", (data,)):
        return False
    if not isinstance(data, dict):
        return True
    if any(name not in data for name in condition.get("required", ())):
        return False
    if "not" in condition and _holds(condition["not"], data):
        return False
    if "anyOf" in condition and not any(_holds(each, data) for each in condition["anyOf"]):
        return False
    inner = condition.get("properties", {})
    return all(_holds(each, data[name]) for name, each in inner.items() if name in data and isinstance(each, dict))
