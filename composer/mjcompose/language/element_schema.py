"""The JSON Schema of MJCF's elements and attributes, from the grammar.

Schemas refer to each other with `{REFERENCE: NAME}`, such as `element:geom`, `named:mesh` or `number`; `define` makes
the schema of a name, only for names that are referred to. Editors show the best errors if there are few alternatives.
Therefore `if` and `then` are used wherever the value shows which alternative applies.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import chain
from typing import Any

from mjcompose.base.words import value_text
from mjcompose.language.element import CONFIG, FRAGMENT, NAME
from mjcompose.language.forms.context import Schema, computable, definition, reference
from mjcompose.text.expression import ANGLE_PATTERN
from mjcompose.tree.grammar import GRAMMAR, Attribute, Constraint, ElementType
from mjcompose.tree.values import INT_MAX, INT_MIN, may_be_angle

TEMPLATE_PATTERN = r"\$\{"
_NUMBER_PATTERN = f"^{ANGLE_PATTERN}$|{TEMPLATE_PATTERN}"
_NUMBER_HINT = "expected a number, an angle such as 90deg or 1.57rad, or ${…}"
_PLAIN_HINT = "expected a number, or ${…}"
_ITEMS = {"real": "plain", "int": "integer"}

# Schemas that many attributes share.
SHARED: dict[str, Schema] = {
    "number": {"type": ["number", "string"], "pattern": _NUMBER_PATTERN, "patternErrorMessage": _NUMBER_HINT},
    "plain": {"type": ["number", "string"], "pattern": TEMPLATE_PATTERN, "patternErrorMessage": _PLAIN_HINT},
    "integer": {"type": ["integer", "string"], "minimum": INT_MIN, "maximum": INT_MAX, "pattern": TEMPLATE_PATTERN,
                "patternErrorMessage": "expected an integer, or ${…}"},
    "boolean": {"type": ["boolean", "string"], "pattern": TEMPLATE_PATTERN,
                "patternErrorMessage": "expected true, false, or ${…}"},
    "fragment": {"type": "string", "pattern": f"<|{TEMPLATE_PATTERN}",
                 "patternErrorMessage": "expected an element of MJCF: <geom …/>",
                 "description": "a fragment of MJCF in place of the element"},
    "template": {"type": "string", "pattern": TEMPLATE_PATTERN},
}  # fmt: skip


def _shared(kind: str, lengths: str) -> Schema:
    """Return the schema of one of `SHARED`, or of a list of it, with the lengths `3`, `1-2` or `1-`."""
    if not lengths:
        return dict(SHARED[kind])
    low, *rest = lengths.split("-")
    schema = _list(kind, int(low))
    high = int(low) if not rest else int(rest[0]) if rest[0] else None
    if high is not None:
        schema["maxItems"] = high
    return schema


for _kind in SHARED:
    definition(_kind)(partial(_shared, _kind))


def attribute_schema(attribute: Attribute, tag: str) -> Schema:
    """Return the schema of an attribute of elements with a tag. Its explanation has the default, which editors would
    write otherwise.
    """
    schema = _values(attribute, tag)
    remarks = ", ".join(_remarks(attribute))
    description = " ".join(filter(None, [attribute.doc, remarks and f"({remarks})"]))
    if description:
        schema["description"] = description
    return schema


def _remarks(attribute: Attribute) -> Iterator[str]:
    if attribute.refers is not None:
        kind = {"default": "default class"}.get(attribute.refers, attribute.refers.removeprefix("attached:"))
        if kind not in attribute.doc or kind == attribute.doc:
            yield f"names of {kind}s" if attribute.type == "references" else f"name of a {kind}"
    elif attribute.refers_by is not None:
        yield f"of the kind that `{attribute.refers_by}` names"
    if attribute.type == "file":
        yield "file, relative to the recipe"
    if attribute.default is not None:
        yield f"default: {value_text(attribute.default)}"
    yield from attribute.versions()


def _values(attribute: Attribute, tag: str) -> Schema:
    kind = attribute.type
    if kind in _ITEMS:
        return _numbers(attribute, "number" if may_be_angle(tag, attribute) else _ITEMS[kind])
    if kind == "bool":
        return reference("boolean")
    if kind == "keyword":
        return computable({"enum": _words(attribute)})
    if kind == "keywords":
        words: Schema = {"enum": _words(attribute)}
        several: Schema = {"type": "array", "items": words, "minItems": 1, "uniqueItems": True}
        return {"anyOf": [several, words, reference("template")]}
    if kind == "references":
        return {"type": ["array", "string"], "items": {"type": "string"}, "minItems": 1}
    if kind == "chars":
        low = attribute.min_length or 0
        high = "" if attribute.max_length is None else attribute.max_length
        return {"type": "string", "pattern": f"^.{{{low},{high}}}$|{TEMPLATE_PATTERN}"}
    is_needed = attribute.required and attribute.name != "name"  # an empty name keeps an element unnamed
    return {"type": "string", "minLength": 1} if is_needed else {"type": "string"}


def _numbers(attribute: Attribute, item: str) -> Schema:
    low = attribute.min_length or 0
    high = attribute.max_length
    if attribute.lengths is not None:
        return {"anyOf": [reference(f"{item}-{length}") for length in attribute.lengths]}
    if high == 1:
        return reference(item)
    if low == high:
        return reference(f"{item}-{low}")
    return reference(f"{item}-{low}-{'' if high is None else high}")


def _list(item: str, low: int) -> Schema:
    """Return the schema of a list of numbers. One number is a list of one, and `${…}` is any list."""
    # If `items` is at the top, editors write a new list with dashes, which is an error inside of `{ }`.
    schema: Schema = {"type": ["array", "string"], "allOf": [{"items": reference(item)}], "minItems": low}
    places = ", ".join(f"${place}" for place in range(1, max(low, 1) + 1))
    schema["defaultSnippets"] = [{"body": f"[{places}]"}]  # editors insert it for a new list
    single = SHARED[item]
    if low <= 1:
        return {**single, **schema, "type": ["array", *single["type"]]}
    noun = "numbers" if item == "plain" else f"{item}s"
    hint = f"expected a list of {low} {noun}" if low else f"expected a list of {noun}"
    return {**schema, "pattern": TEMPLATE_PATTERN, "patternErrorMessage": hint}


def _words(attribute: Attribute) -> list[Any]:
    words: list[Any] = list(attribute.keywords)
    words += [word == "true" for word in attribute.keywords if word in ("true", "false")]
    return [*words, *(int(word) for word in attribute.keywords if word.isdigit())]


definition("element")(lambda path: element(GRAMMAR.element(path)))
definition("attributes")(lambda path: element(GRAMMAR.element(path), fragment=False, children=False))


@definition("named")
def _definition_of_named(path: str) -> Schema:
    kind = GRAMMAR.element(path)
    return element(kind, (NAME,), {} if kind.attributes[NAME].required else nameless())


def nameless() -> dict[str, Schema]:
    """Return the key that says that the key of an entry is not the name of the element."""
    return {NAME: reference("nameless")}


def element(
    kind: ElementType,
    keyed: Sequence[str] = (),
    properties: dict[str, Schema] | None = None,
    required: Sequence[str] = (),
    fragment: bool = True,
    children: bool = True,
) -> Schema:
    """Return the schema of an element: attributes, children and rules; and, where allowed, a fragment."""
    known: dict[str, Schema] = dict(properties or {})
    for name, attribute in kind.attributes.items():
        if name not in keyed:
            known.setdefault(name, attribute_schema(attribute, kind.tag))
    if children:
        for tag, child in kind.children.items():
            known.setdefault(tag, _settings() if tag == CONFIG else _children(child))
    rules = _rules(kind, keyed, required)
    description = {"description": kind.doc} if kind.doc else {}
    if not fragment:
        if "required" in rules:
            # Editors offer a schema with `required` at its top as one completion, under the name of its definition.
            rules["allOf"] = [{"required": rules.pop("required")}, *rules.get("allOf", ())]
        return {**mapping(known), **description, **rules}
    known.setdefault(FRAGMENT, reference("fragment"))
    return {**mapping(known), **description, **unless_fragment(rules, properties or {})}


def _rules(kind: ElementType, keyed: Sequence[str], required: Sequence[str]) -> Schema:
    """Return which attributes are required, and which conditions hold among them."""
    rules: Schema = {}
    needed = [name for name, attribute in kind.attributes.items() if attribute.required and name not in keyed]
    if needed or required:
        rules["required"] = [*required, *needed]
    conditions = [condition for rule in kind.constraints for condition in _rule(rule)]
    if conditions:
        rules["allOf"] = conditions
    return rules


def unless_fragment(rules: Schema, beside: Iterable[str] = ()) -> Schema:
    """Return the condition that a fragment is alone, except for the keys `beside` it, or else that the rules hold."""
    beside = [name for name in beside if name == NAME]
    then: Schema = {"propertyNames": {"enum": [FRAGMENT, *beside]}} if beside else {"maxProperties": 1}
    alone: Schema = {"if": {"required": [FRAGMENT]}, "then": then}
    return {**alone, "else": rules} if rules else alone


def one_or_more(kind: ElementType) -> Schema:
    """Return the schema of an element, or of a list of them that has one or more."""
    schema = _children(kind)
    return {**schema, "then": {**schema["then"], "minItems": 1}}


def _children(kind: ElementType) -> Schema:
    one = reference(f"element:{kind.path}")
    several: Schema = {"items": one}
    if kind.max_count is not None:
        several["maxItems"] = kind.max_count
    return described({"type": ["object", "array"], "if": {"type": "array"}, "then": several, "else": one}, kind.doc)


def _settings() -> Schema:
    single: Schema = {"type": ["string", "number", "boolean"]}
    message = "the settings of the plugin, by its own keys"
    return described(by_name({"type": [*single["type"], "array"], "items": single}), message)


def _rule(rule: Constraint) -> list[Schema]:
    bundles = [list(bundle) for bundle in rule.bundles]
    if rule.kind == "exclusive":
        # Not with `not`, for which an editor can only say that it does not hold.
        return [
            {
                "if": {"required": [name]},
                "then": {
                    "properties": dict.fromkeys(chain(*bundles[index + 1 :]), False),
                    "errorMessage": f"`{name}` exists already, and only one of the two is allowed",
                },
            }
            for index, bundle in enumerate(bundles[:-1])
            for name in bundle
        ]
    if rule.kind == "oneof":
        return [{"anyOf": [{"required": bundle} for bundle in bundles]}]
    if rule.kind == "together":
        names = [name for bundle in bundles for name in bundle]
        anyone: Schema = {"anyOf": [{"required": [name]} for name in names]}
        return [{"if": anyone, "then": {"required": names}}]
    asking, asked = bundles
    return [{"if": {"required": asking}, "then": {"required": asked}}]


def mapping(properties: dict[str, Schema]) -> Schema:
    return {"type": "object", "properties": properties, "additionalProperties": False}


def described(schema: Schema, description: str) -> Schema:
    return {**schema, "description": description} if description else schema


def by_name(value: Schema) -> Schema:
    """Return the schema of a mapping from names."""
    return {"type": "object", "additionalProperties": value}


_NAMELESS = computable({"const": "", "description": '`""`: the element has no name; the key is not its name'})
definition("nameless")(lambda _: _NAMELESS)
