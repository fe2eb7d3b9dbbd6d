"""The JSON Schema of the fields of `randomize`."""

from __future__ import annotations

from composer.recipe.count import SCHEMAS as COUNTS
from composer.recipe.distribution import BELLS, CHOICE, INTERVALS, KINDS
from composer.recipe.draw_field import KEYS, PER
from composer.recipe.reference import Schema, definition, reference
from composer.recipe.rows import check_rows

_TEXT: Schema = {"type": "string", "minLength": 1}
_BOUND: Schema = {
    "anyOf": [reference("number"), {"type": "array", "items": reference("number"), "minItems": 1}]
}
_ABOUT = {
    "uniform": "between two bounds, all numbers as likely: `[0.4, 1.2]`",
    "loguniform": "between two positive bounds, all orders of magnitude as likely: `[0.1, 10]`",
    "integers": "whole numbers from the first to the last: `[1, 6]`",
    "normal": "a bell about `mean` with the standard deviation `std`",
    "truncnormal": "the part of a normal distribution that is between `min` and `max`",
    "lognormal": "numbers whose logarithm is normal, with this mean and standard deviation",
    CHOICE: "one of these values, all as likely",
}
_KEYS = {
    "mean": "the middle; of `lognormal` that of the logarithm. Without it: what changes nothing",
    "std": "the standard deviation; of `lognormal` that of the logarithm",
    "min": "the least that is drawn",
    "max": "the greatest that is drawn",
}


def fields() -> Schema:
    """Return the schema of the mapping `fields`."""
    return {"type": "object", "minProperties": 1, "additionalProperties": reference("draw")}


_DISTRIBUTIONS = {kind: {**reference(f"distribution:{kind}"), "description": _ABOUT[kind]} for kind in KINDS}
_ONE: Schema = {
    "type": "object",
    "properties": _DISTRIBUTIONS,
    "additionalProperties": False,
    "minProperties": 1,
    "maxProperties": 1,
}
_FIELD: dict[str, Schema] = {
    "select": {**reference("selector"), "description": "whose attribute is drawn"},
    "attr": {
        **_TEXT,
        "description": "an attribute of MJCF, with an index for one number: `friction[0]`",
    },
    "param": {**_TEXT, "description": "a parameter that is drawn, in place of `select` and `attr`"},
    **_DISTRIBUTIONS,
    "scale": {**_ONE, "description": "what is drawn is a factor"},
    "offset": {**_ONE, "description": "what is drawn is added"},
    "per": {
        "enum": [*PER],
        "description": "a draw for each element, for each body, for each part, or one for all in a sample",
    },
    "group": {
        **_TEXT,
        "description": "fields of one group are drawn together: where one is high in its distribution, all are",
    },
    **COUNTS,
}
check_rows("the JSON Schema of `fields` in composer/recipe/randomize_schema.py", _FIELD, KEYS)


@definition("draw")
def field(_: str) -> Schema:
    """Return the schema of one field."""
    return {
        "type": "object",
        "properties": dict(_FIELD),
        "additionalProperties": False,
        "minProperties": 2,
        "if": {"required": ["param"]},
        "then": {"properties": {"select": False, "attr": False, "per": False}},
        "else": {"required": ["select", "attr"]},
    }


@definition("distribution")
def distribution(kind: str) -> Schema:
    """Return the schema of the value behind the name of a distribution."""
    if kind == CHOICE:
        return {"type": "array", "minItems": 1}
    if kind in INTERVALS:
        return {"type": "array", "items": _BOUND, "minItems": 2, "maxItems": 2}
    keys = BELLS[kind][1]
    return {
        "type": "object",
        "properties": {key: {**_BOUND, "description": _KEYS[key]} for key in keys},
        "required": [key for key in keys if key != "mean"],
        "additionalProperties": False,
    }
