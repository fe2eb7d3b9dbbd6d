"""The JSON Schema of the attributes that `edit` can change, by the tag of the selector.

For rare tags, any attribute is accepted.
"""

from __future__ import annotations

from composer.grammar import GRAMMAR
from composer.grammar.attribute import Attribute
from composer.recipe.attribute_schema import TEMPLATE_PATTERN, attribute_schema
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.verbs.values import MASS
from composer.tree.selector import paths_of

# The tags that people edit. Each further one makes the schema longer.
TAGS = (
    "body", "frame", "geom", "site", "joint", "freejoint", "camera", "light", "inertial", "mesh", "material", "texture",
    "hfield", "skin", "exclude", "pair", "actuator", "equality", "tendon", "sensor",
)  # fmt: skip


@definition("settable")
def settable(tag: str) -> Schema:
    """Return the schema of a mapping from the attributes of a tag, and from single numbers of them, to their values."""
    found: dict[str, Schema] = {}
    for name, attributes in attributes_of(tag).items():
        schemas = [attribute_schema(each) for each in attributes]
        same = all({**each, "description": ""} == {**schemas[0], "description": ""} for each in schemas)
        found[name] = schemas[0] if same else {"description": schemas[0].get("description", "")}
    return _numbered(tag, found, reference("number"))


@definition("scalable")
def scalable(tag: str) -> Schema:
    """Return the schema of a mapping from attributes that are numbers to factors or offsets."""
    found = {
        name: {**reference("amount"), "description": attributes[0].doc}
        for name, attributes in attributes_of(tag).items()
        if any(each.is_number for each in attributes)
    }
    return _numbered(tag, found, reference("amount"))


def _numbered(tag: str, properties: dict[str, Schema], number: Schema) -> Schema:
    if tag == "body":
        properties[MASS] = {**reference("number"), "description": "the body's whole inertia, in proportion"}
    several = [
        name
        for name, attributes in attributes_of(tag).items()
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


def attributes_of(tag: str) -> dict[str, list[Attribute]]:
    """Return the attributes of all elements that a tag means, except for names, which `rename` changes."""
    found: dict[str, list[Attribute]] = {}
    for path in sorted(paths_of(tag)):
        for each in GRAMMAR.element(path).attributes.values():
            if each.name != "name":
                found.setdefault(each.name, []).append(each)
    return found


@definition("amount")
def amount(_: str) -> Schema:
    """Return the schema of a number, a list of them, or an expression of `${value}`."""
    return {
        "type": ["number", "string", "array"],
        "pattern": TEMPLATE_PATTERN,
        "items": reference("number"),
        "patternErrorMessage": "expected a number, a list of numbers, or ${…}",
    }
