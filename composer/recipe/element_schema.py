"""The JSON Schema of MJCF's elements, from the grammar.

Schemas refer to each other with `{REFERENCE: NAME}`, such as `element:geom`, `named:mesh` or `number`; `define`
makes the schema of a name. Only what is referred to is made. Editors show the best errors if there are few
alternatives. Therefore `if` and `then` are used wherever the value shows which alternative is meant.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from composer.grammar import GRAMMAR
from composer.grammar.element import Constraint, ElementType
from composer.recipe.attribute_schema import attribute_schema
from composer.recipe.reader import CONFIG, FRAGMENT, NAME
from composer.recipe.reference import Schema, definition, reference


def at_most_one(names: Iterable[str]) -> list[Schema]:
    """Return the condition that at most one of some keys is written."""
    return _rule(Constraint("exclusive", tuple((name,) for name in names)))


@definition("element")
def _definition_of_element(path: str) -> Schema:
    return element(GRAMMAR.element(path))


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
    for name, each in kind.attributes.items():
        if name not in keyed:
            known.setdefault(name, attribute_schema(each))
    for tag, child in kind.children.items() if children else ():
        known.setdefault(tag, _settings() if tag == CONFIG else _children(child))
    rules: Schema = {}
    needed = [name for name, each in kind.attributes.items() if each.required and name not in keyed]
    if needed or required:
        rules["required"] = [*required, *needed]
    conditions = [condition for rule in kind.constraints for condition in _rule(rule)]
    if conditions:
        rules["allOf"] = conditions
    description = {"description": kind.doc} if kind.doc else {}
    if not fragment:
        if "required" in rules:
            # Editors offer a schema with `required` at its top as one completion, under the name of its definition.
            rules["allOf"] = [{"required": rules.pop("required")}, *conditions]
        return {**mapping(known), **description, **rules}
    known.setdefault(FRAGMENT, reference("fragment"))
    return {**mapping(known), **description, **unless_fragment(rules, properties or {})}


def unless_fragment(rules: Schema, beside: Iterable[str] = ()) -> Schema:
    """Return the condition that a fragment is alone, except for the keys `beside` it, and else the rules hold."""
    beside = [name for name in beside if name == NAME]
    then: Schema = {"propertyNames": {"enum": [FRAGMENT, *beside]}} if beside else {"maxProperties": 1}
    alone: Schema = {"if": {"required": [FRAGMENT]}, "then": then}
    return {**alone, "else": rules} if rules else alone


def _children(kind: ElementType) -> Schema:
    """Return the schema of elements with one tag: one as a mapping, several as a list."""
    one = reference(f"element:{kind.path}")
    several: Schema = {"items": one}
    if kind.max_count is not None:
        several["maxItems"] = kind.max_count
    return described(
        {"type": ["object", "array"], "if": {"type": "array"}, "then": several, "else": one}, kind.doc
    )


def _settings() -> Schema:
    single: Schema = {"type": ["string", "number", "boolean"]}
    return described(
        by_name({"type": [*single["type"], "array"], "items": single}),
        "the settings of the plugin, by its own keys",
    )


def _rule(rule: Constraint) -> list[Schema]:
    """Return the schema of a rule about the presence of attributes."""
    bundles = [list(bundle) for bundle in rule.bundles]
    if rule.kind == "exclusive":
        # Not with `not`, for which an editor can only say that it does not hold.
        return [
            {
                "if": {"required": [name]},
                "then": {
                    "properties": {other: False for others in bundles[index + 1 :] for other in others},
                    "errorMessage": f"`{name}` exists already, and only one of the two may stand",
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
    """Return the schema of a mapping with these keys and no others."""
    return {"type": "object", "properties": properties, "additionalProperties": False}


def described(schema: Schema, description: str) -> Schema:
    """Return the schema with a description, if there is one."""
    return {**schema, "description": description} if description else schema


def by_name(value: Schema) -> Schema:
    """Return the schema of a mapping from names."""
    return {"type": "object", "additionalProperties": value}


@definition("nameless")
def _definition_of_nameless(_: str) -> Schema:
    return {
        "const": "",
        "description": '`""`: the element has no name; the key is not its name',
    }
