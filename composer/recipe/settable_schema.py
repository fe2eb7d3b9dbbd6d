"""JSON Schema of the attributes that `edit` changes, by the tag of the selector; of rare tags any may stand there."""

from __future__ import annotations

from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.recipe.attribute_schema import TEMPLATE_PATTERN, attribute_schema
from composer.recipe.edit_values import CONVERTIBLE, FROM, MASS
from composer.recipe.reference import Schema, reference
from composer.tree.selector import paths_of

# Those that are edited; every further one makes the schema longer.
TAGS = (
    "body", "frame", "geom", "site", "joint", "freejoint", "camera", "light", "inertial", "mesh", "material", "texture",
    "hfield", "skin", "exclude", "pair", "actuator", "equality", "tendon", "sensor",
)  # fmt: skip
CHANGES = {
    "unset": "attributes that are no longer written",
    "set": "attributes and their new values, `friction[0]` for one number",
    "scale": "attributes and what they are multiplied with",
    "offset": "attributes and what is added to them",
}
_CLASSES = "default"


def by_tag() -> list[Schema]:
    """Conditions on an entry of `edit`: what its verbs may name, by the tag that is selected."""
    conditions = [_where_selected(tag, _verbs(tag)) for tag in TAGS]
    rows = [tag for tag in GRAMMAR.section(_CLASSES).children if tag != _CLASSES]
    settings: Schema = {"propertyNames": {"enum": rows}, "additionalProperties": {"type": "object"}}
    classes = {verb: {**settings, "description": CHANGES[verb]} for verb in ("set", "scale", "offset")}
    return [*conditions, _where_selected(_CLASSES, classes)]


def conversions() -> list[Schema]:
    """Conditions on `convert`: the attributes of the kind that the actuator becomes."""
    taken: Schema = {"type": "string", "pattern": f"^{FROM}"}
    found: list[Schema] = []
    for kind in CONVERTIBLE:
        attributes = GRAMMAR.element(f"actuator/{kind}").attributes.values()
        given = {
            each.name: _either(attribute_schema(each), taken) for each in attributes if each.name != "name"
        }
        target: Schema = {"properties": {"to": {"const": kind}}, "required": ["to"]}
        then: Schema = {"properties": {"to": KIND, **given}, "additionalProperties": False}
        found.append({"if": target, "then": then})
    return found


def settable(tag: str) -> Schema:
    """A mapping from the attributes of what a tag means to their values, and from single numbers of them."""
    found: dict[str, Schema] = {}
    for name, attributes in _attributes(tag).items():
        schemas = [attribute_schema(each) for each in attributes]
        same = all({**each, "description": ""} == {**schemas[0], "description": ""} for each in schemas)
        found[name] = schemas[0] if same else {"description": schemas[0].get("description", "")}
    return _numbered(tag, found, reference("number"))


def scalable(tag: str) -> Schema:
    """The same of what is a number, with what it is multiplied with or what is added to it."""
    found = {
        name: {**reference("amount"), "description": attributes[0].doc}
        for name, attributes in _attributes(tag).items()
        if any(each.is_number for each in attributes)
    }
    return _numbered(tag, found, reference("amount"))


def _numbered(tag: str, properties: dict[str, Schema], number: Schema) -> Schema:
    if tag == "body":
        properties[MASS] = {**reference("number"), "description": "the body's whole inertia, in proportion"}
    several = [
        name
        for name, attributes in _attributes(tag).items()
        if any(each.is_number and each.max_length != 1 for each in attributes)
    ]
    schema: Schema = {
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "minProperties": 1,
    }
    if several:
        schema["patternProperties"] = {rf"^({'|'.join(several)})\[[0-9]+\]$": number}
    return schema


def _verbs(tag: str) -> dict[str, Schema]:
    forms: dict[str, Schema] = {
        "unset": {"type": "array", "items": {"enum": list(_attributes(tag))}, "minItems": 1},
        "set": reference(f"settable:{tag}"),
        "scale": reference(f"scalable:{tag}"),
        "offset": reference(f"scalable:{tag}"),
    }
    return {verb: {**form, "description": CHANGES[verb]} for verb, form in forms.items()}


def _where_selected(tag: str, verbs: dict[str, Schema]) -> Schema:
    selected: Schema = {"properties": {"select": {"required": [tag]}}, "required": ["select"]}
    return {"if": selected, "then": {"properties": verbs}}


def _attributes(tag: str) -> dict[str, list[Attribute]]:
    """The attributes of all elements that a tag means, but for names, which `rename` is for."""
    found: dict[str, list[Attribute]] = {}
    for path in sorted(paths_of(tag)):
        for each in GRAMMAR.element(path).attributes.values():
            if each.name != "name":
                found.setdefault(each.name, []).append(each)
    return found


def _either(schema: Schema, other: Schema) -> Schema:
    both: Schema = {"anyOf": [{key: each for key, each in schema.items() if key != "description"}, other]}
    return {**both, "description": schema["description"]} if "description" in schema else both


KIND: Schema = {"enum": [*CONVERTIBLE], "description": "the kind of actuator that it becomes"}
# A number, one of several, or what is computed of `${value}`.
AMOUNT: Schema = {
    "type": ["number", "string", "array"],
    "pattern": TEMPLATE_PATTERN,
    "items": reference("number"),
    "patternErrorMessage": "expected a number, a list of numbers, or ${…}",
}
