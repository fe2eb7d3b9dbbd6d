"""The JSON Schema of models, for editors: pydantic's own, without null, and with `${…}` for values that it computes."""

from __future__ import annotations

from functools import cache
from typing import Any

from pydantic import GetJsonSchemaHandler
from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import CoreSchema

from mjcompose.language.forms.context import ELSEWHERE, LIST, Schema, computable, definition, reference
from mjcompose.language.forms.model import Model, fields_of, is_hidden, is_whole, rest_of, rows_of
from mjcompose.language.forms.source_text import text_of, texts_below

_TEMPLATE = r"\$\{"


def _number(kind: str, noun: str) -> Schema:
    return {"type": [kind, "string"], "pattern": _TEMPLATE, "patternErrorMessage": f"expected {noun}, or ${{…}}"}


definition("real")(lambda _: _number("number", "a number"))
definition("whole")(lambda _: _number("integer", "a whole number"))


class Generator(GenerateJsonSchema):
    """Our models accept `${…}` for every number, flag and keyword, because the schema describes unexpanded recipes."""

    _ours = False

    def model_schema(self, schema: Any) -> Schema:
        before = self._ours
        self._ours = issubclass(schema["cls"], Model)
        try:
            found = super().model_schema(schema)
        finally:
            self._ours = before
        found.pop("title", None)
        return found

    def function_plain_schema(self, schema: Any) -> Schema:
        elsewhere = schema.get("metadata", {}).get(ELSEWHERE)
        if elsewhere is None:
            return super().function_plain_schema(schema)
        found: Schema = elsewhere.schema(self.generate_inner)
        return found

    def float_schema(self, schema: Any) -> Schema:
        return self._number(super().float_schema(schema), "real")

    def int_schema(self, schema: Any) -> Schema:
        return self._number(super().int_schema(schema), "whole")

    def _number(self, schema: Schema, shared: str) -> Schema:
        if not self._ours:
            return schema
        return {**reference(shared), **{key: each for key, each in schema.items() if key != "type"}}

    def tuple_schema(self, schema: Any) -> Schema:
        return self._list(super().tuple_schema(schema))

    def list_schema(self, schema: Any) -> Schema:
        return self._list(super().list_schema(schema))

    def _list(self, schema: Schema) -> Schema:
        """Return the schema of a list, which `${…}` may give if its items are values: a recipe computes no mappings."""
        is_of_models = "$ref" in schema.get("items", {})
        return {**schema, "type": LIST, "pattern": _TEMPLATE} if self._ours and not is_of_models else schema

    def bool_schema(self, schema: Any) -> Schema:
        return reference("boolean") if self._ours else super().bool_schema(schema)

    def literal_schema(self, schema: Any) -> Schema:
        found = super().literal_schema(schema)
        if not self._ours:
            return found
        return computable({"enum": found["enum"] if "enum" in found else [found["const"]]})

    def nullable_schema(self, schema: Any) -> Schema:
        return self.generate_inner(schema["schema"]) if self._ours else super().nullable_schema(schema)

    def tagged_union_schema(self, schema: Any) -> Schema:
        found = super().tagged_union_schema(schema)
        return {"anyOf": found.pop("oneOf"), **found}

    def default_schema(self, schema: Any) -> Schema:
        found = super().default_schema(schema)
        if self._ours and found.get("default", ...) in (None, [], {}, ""):
            del found["default"]
        return found

    def field_title_should_be_set(self, schema: Any) -> bool:
        return not self._ours and super().field_title_should_be_set(schema)


def of_model(model: type[Model], schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
    found = handler.resolve_ref_schema(handler(schema))
    description = text_of(model)
    if description:
        found["description"] = description
    properties: dict[str, Schema] = {}
    written = found["properties"]
    for key, info in fields_of(model).items():
        if (rows := rows_of(info)) is not None:
            properties |= {word: written[key][word] for word in rows.table().own}
        else:
            properties[key] = written[key]
            properties[key].pop("examples", None)  # an editor would offer them as values
            if (about := descriptions(model).get(key)) is not None:
                properties[key]["description"] = about
    if is_whole(model):
        (whole,) = (each for key, each in properties.items() if is_hidden(key))
        return whole
    if (beside := rest_of(model)) is not None:
        rest = written[beside]
        properties |= rest.pop("properties", {})
        if "propertyNames" in rest:
            rest["propertyNames"] = {"enum": [*model.key_names(), *rest["propertyNames"]["enum"]]}
        found |= rest
        found["required"] = [name for name in found.get("required", ()) if not is_hidden(name)]
        properties = {name: each for name, each in properties.items() if not is_hidden(name)}
    found["properties"] = properties
    if conditions := [each for rule in model.rules for each in rule.schema()]:
        found["allOf"] = [*found.get("allOf", ()), *conditions]
    if model.short is None:
        return found
    return {"anyOf": [{key: each for key, each in written[model.short].items() if key != "description"}, found]}


@cache
def descriptions(model: type[Model]) -> dict[str, str]:
    """Return the text below each field, by its key. Pydantic would read them for each class that is imported."""
    names = {name: info.alias or name for name, info in model.model_fields.items()}
    found: dict[str, str] = {}
    for each in reversed(model.__mro__):
        if issubclass(each, Model):
            found |= {names[name]: text for name, text in texts_below(each).items() if name in names}
    return found
