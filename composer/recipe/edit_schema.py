"""JSON Schema of `edit` and `drop`."""

from __future__ import annotations

from composer.grammar import GRAMMAR
from composer.recipe.edit_values import VERBS
from composer.recipe.pattern import GLOB
from composer.recipe.placing import ORIENTATIONS
from composer.recipe.reference import Schema, reference
from composer.recipe.settable_schema import CHANGES, KIND, by_tag, conversions
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
    values: Schema = {"type": "object", "minProperties": 1}
    attributes: Schema = {"type": "array", "items": _TEXT, "minItems": 1}
    named: Schema = {**_TEXT, "description": "the name of a frame"}
    frame = {"type": "object", "properties": {"frame": named}, "required": ["frame"]}
    pose = {
        name: {"type": ["array", "string"], "description": f"`{name}` in what it then stands in"}
        for name in ("pos", *ORIENTATIONS)
    }
    place: Schema = {"anyOf": [_TEXT, frame], "description": "a body, `world`, or `{frame: NAME}`"}
    properties: Schema = {
        "select": {**reference("selector"), "description": "which elements are meant"},
        **_COUNT,
        "unset": {
            "anyOf": [attributes, {"type": "object", "additionalProperties": attributes}],
            "description": CHANGES["unset"],
        },
        "set": {**values, "description": CHANGES["set"]},
        "scale": {**values, "description": CHANGES["scale"]},
        "offset": {**values, "description": CHANGES["offset"]},
        "convert": {
            "type": "object",
            "properties": {"to": KIND},
            "required": ["to"],
            "allOf": conversions(),
            "description": "another kind of actuator, and attributes of it",
        },
        "move": {
            "type": "object",
            "properties": {"to": place, **pose},
            "required": ["to"],
            "additionalProperties": False,
            "description": "another body or frame to stand in, and the pose there",
        },
        "rename": {**_TEXT, "description": "the new name, which every reference follows"},
        "remove": {
            "enum": [True, "cascade"],
            "description": "take it out: `true` if nothing refers to it, `cascade` with all that does",
        },
        "id": {
            **_TEXT,
            "description": "a name by which a recipe that extends this one can replace the entry",
        },
        "when": {"description": "the builds that it belongs to"},
    }
    others = [name for name in properties if name in VERBS]
    return {
        "type": "object",
        "properties": properties,
        "required": ["select"],
        "additionalProperties": False,
        "minProperties": 2,
        "if": {"required": ["remove"]},
        "then": {
            "properties": dict.fromkeys(others, False),
            "errorMessage": "`remove` stands alone",
        },
        "allOf": by_tag(),
    }


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
