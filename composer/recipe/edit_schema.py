"""The JSON Schema of `edit` and `drop`."""

from __future__ import annotations

from composer.grammar import GRAMMAR
from composer.recipe.allow import codes_schema
from composer.recipe.count import SCHEMAS as COUNTS
from composer.recipe.pattern import GLOB
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.rows import check_rows
from composer.recipe.select import NARROWING
from composer.recipe.settable_schema import TAGS
from composer.recipe.verbs.table import VERBS
from composer.tree.selector import known_tags

_TEXT: Schema = {"type": "string", "minLength": 1}
OWN: dict[str, Schema] = {
    "select": {**reference("selector"), "description": "which elements are meant"},
    **COUNTS,
    "id": {
        **_TEXT,
        "description": "a name by which a recipe that extends this one can replace the entry",
    },
    "allow": {
        **codes_schema(),
        "description": "the codes of warnings about it that are meant to be there",
    },
    "when": {"description": "the builds that it belongs to"},
}
"""The keys of an entry of `edit` that are not verbs."""
_NARROWING: dict[str, Schema] = {
    "parent": {**reference("selector"), "description": "the body, or other element, that it stands in"},
    "in": {**reference("selector"), "description": "an element that it stands in, at any depth"},
    "part": {**GLOB, "description": "the part that it came from"},
    "class": {**GLOB, "description": "the default class in effect, or one that it descends from"},
    "where": {
        "type": ["object", "string"],
        "description": "attributes and their values in effect, or one boolean `${…}`",
    },
}
check_rows("the JSON Schema of selectors in composer/recipe/edit_schema.py", _NARROWING, NARROWING)


def edits() -> Schema:
    """Return the schema of the list `edit`."""
    return {"type": "array", "items": reference("edit")}


def drops() -> Schema:
    """Return the schema of the list `drop`."""
    return {"type": "array", "items": {"anyOf": [_TEXT, reference("dropped")]}}


@definition("edit")
def edit(_: str) -> Schema:
    """Return the schema of one entry of `edit`."""
    verbs = {name: {**verb.schema(), "description": verb.description} for name, verb in VERBS.items()}
    first = ("select", *COUNTS)
    properties: Schema = {**{name: OWN[name] for name in first}, **verbs, **OWN}
    return {
        "type": "object",
        "properties": properties,
        "required": ["select"],
        "additionalProperties": False,
        "minProperties": 2,
        "allOf": [*map(_alone, (name for name, verb in VERBS.items() if verb.alone)), *_by_tag()],
    }


def _alone(verb: str) -> Schema:
    """Return the condition that no other verb is written beside this one."""
    others = dict.fromkeys((name for name in VERBS if name != verb), False)
    then = {"properties": others, "errorMessage": f"`{verb}` stands alone"}
    return {"if": {"required": [verb]}, "then": then}


def _by_tag() -> list[Schema]:
    """Return conditions on the attributes that verbs may name, by the tag of the selector."""
    conditions: list[Schema] = []
    for tag in TAGS:
        forms = {name: verb.schema_of_tag(tag) for name, verb in VERBS.items() if verb.schema_of_tag}
        conditions.append(_where_selected(tag, forms))
    forms = {name: verb.schema_of_classes() for name, verb in VERBS.items() if verb.schema_of_classes}
    return [*conditions, _where_selected("default", forms)]


def _where_selected(tag: str, forms: dict[str, Schema]) -> Schema:
    selected: Schema = {"properties": {"select": {"required": [tag]}}, "required": ["select"]}
    verbs = {name: {**form, "description": VERBS[name].description} for name, form in forms.items()}
    return {"if": selected, "then": {"properties": verbs}}


@definition("selector")
def selector(_: str) -> Schema:
    """Return the schema of a mapping from a tag to a glob, with the keys that narrow it down."""
    return {
        "type": "object",
        "properties": dict(_NARROWING),
        "propertyNames": {"enum": [*NARROWING, *known_tags(), *_paths()]},
        "additionalProperties": GLOB,
        "minProperties": 1,
    }


@definition("dropped")
def dropped(_: str) -> Schema:
    """Return the schema of a selector in `drop`, with the number of elements."""
    schema = selector("")
    schema["properties"] |= COUNTS
    schema["propertyNames"] = {"enum": [*COUNTS, *schema["propertyNames"]["enum"]]}
    return schema


def _paths() -> list[str]:
    known = set(known_tags())
    return [path for path in GRAMMAR.paths if "/" in path and path not in known and path != "mujoco/include"]
