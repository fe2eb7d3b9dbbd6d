"""JSON Schema of `edit` and `drop`."""

from __future__ import annotations

from composer.grammar import GRAMMAR
from composer.recipe.pattern import GLOB
from composer.recipe.reference import Schema, reference
from composer.recipe.settable_schema import TAGS
from composer.recipe.verbs.table import VERBS
from composer.tree.selector import known_tags

_TEXT: Schema = {"type": "string", "minLength": 1}
_COUNT: Schema = {
    "expect": {"type": "integer", "minimum": 0, "description": "how many elements must be selected"},
    "optional": {"type": "boolean", "description": "whether it may be that nothing is selected"},
}


def edits() -> Schema:
    """The list `edit`."""
    return {"type": "array", "items": reference("edit")}


def drops() -> Schema:
    """The list `drop`."""
    return {"type": "array", "items": {"anyOf": [_TEXT, reference("dropped")]}}


def edit() -> Schema:
    """One entry of `edit`."""
    verbs = {name: {**verb.schema(), "description": verb.description} for name, verb in VERBS.items()}
    properties: Schema = {
        "select": {**reference("selector"), "description": "which elements are meant"},
        **_COUNT,
        **verbs,
        "id": {
            **_TEXT,
            "description": "a name by which a recipe that extends this one can replace the entry",
        },
        "when": {"description": "the builds that it belongs to"},
    }
    return {
        "type": "object",
        "properties": properties,
        "required": ["select"],
        "additionalProperties": False,
        "minProperties": 2,
        "allOf": [*map(_alone, (name for name, verb in VERBS.items() if verb.alone)), *_by_tag()],
    }


def _alone(verb: str) -> Schema:
    """The condition that no other verb is written beside one."""
    others = dict.fromkeys((name for name in VERBS if name != verb), False)
    then = {"properties": others, "errorMessage": f"`{verb}` stands alone"}
    return {"if": {"required": [verb]}, "then": then}


def _by_tag() -> list[Schema]:
    """Conditions on an entry of `edit`: what its verbs may name, by the tag that is selected."""
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


def selector() -> Schema:
    """A mapping from a tag to a glob, and what narrows it down."""
    narrowing: Schema = {
        "parent": {**reference("selector"), "description": "the body, or other element, that it stands in"},
        "in": {**reference("selector"), "description": "an element that it stands in, at any depth"},
        "part": {**GLOB, "description": "the part that it came from"},
        "class": {**GLOB, "description": "the default class in effect, or one that it descends from"},
        "where": {
            "type": ["object", "string"],
            "description": "attributes and their values in effect, or one boolean `${…}`",
        },
    }
    return {
        "type": "object",
        "properties": narrowing,
        "propertyNames": {"enum": [*narrowing, *known_tags(), *_paths()]},
        "additionalProperties": GLOB,
        "minProperties": 1,
    }


def dropped() -> Schema:
    """A selector in `drop`, with how many elements it must mean."""
    schema = selector()
    schema["properties"] |= _COUNT
    schema["propertyNames"] = {"enum": [*_COUNT, *schema["propertyNames"]["enum"]]}
    return schema


def _paths() -> list[str]:
    known = set(known_tags())
    return [path for path in GRAMMAR.paths if "/" in path and path not in known and path != "mujoco/include"]
