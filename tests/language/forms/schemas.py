"""The JSON Schema of a form, with a definition for each model in it."""

from __future__ import annotations

from typing import Any

from mjcompose.language.forms import context
from mjcompose.language.forms.context import Schema, reference
from mjcompose.language.forms.json_schema import Generator
from pydantic import TypeAdapter

_DEFS = "#/$defs/"
_MODELS: dict[str, Schema] = {}


def schema_of(form: Any) -> Schema:
    """Return the JSON Schema of a type, in which each model inside it is `reference("form:NAME")`."""
    context._DEFINITIONS["form"] = _MODELS.__getitem__
    found: Schema = TypeAdapter(form).json_schema(schema_generator=Generator, ref_template=_DEFS + "{model}")
    for name, each in found.pop("$defs", {}).items():
        each = _referring(each)
        if _MODELS.setdefault(name, each) != each:
            raise TypeError(f"two models are called {name}")
    found = _referring(found)
    return _MODELS[found["mjcf"].removeprefix("form:")] if set(found) == {"mjcf"} else found


def _referring(value: Any) -> Any:
    if isinstance(value, list):
        return [_referring(each) for each in value]
    if not isinstance(value, dict):
        return value
    found = {key: _referring(each) for key, each in value.items() if key != "$ref"}
    target = value.get("$ref")
    return found if target is None else {**reference(f"form:{target.removeprefix(_DEFS)}"), **found}
