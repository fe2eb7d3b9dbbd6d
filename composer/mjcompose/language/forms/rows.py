"""Keys whose forms are declared elsewhere: in a module that is imported when a recipe uses the key, or in a table."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import Any

from pydantic import BaseModel, GetCoreSchemaHandler, TypeAdapter, ValidationError, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from mjcompose.base.extensions import Table
from mjcompose.language.forms.context import Schema, settings, together

ELSEWHERE = "mjcompose"
"""The key of pydantic's metadata for forms declared elsewhere: `Generator` asks them for their JSON Schema."""


@cache
def loaded(target: str) -> Any:
    """Import the object that `module:Name` names.

    >>> loaded("mjcompose.language.forms.rows:Lazy").__name__
    'Lazy'
    """
    module, _, name = target.partition(":")
    return getattr(import_module(module), name)


def form_of(row: Any) -> Any:
    """Return the type behind a row of a table or a `module:Name`."""
    return loaded(row) if isinstance(row, str) else row


def first_line(text: str) -> str:
    """Return the first paragraph of a docstring on one line."""
    return " ".join(text.partition("\n\n")[0].split())


class _Adapters(dict[int, tuple[Any, TypeAdapter[Any]]]):
    """The validators of forms, each built on first use."""

    def of(self, form: Any) -> TypeAdapter[Any]:
        found = self.get(id(form))
        if found is None:
            found = self[id(form)] = form, TypeAdapter(form)
        return found[1]


_ADAPTERS = _Adapters()


def validated(form: Any, value: Any, context: Any = None) -> Any:
    """Return the value that a form reads. Raises pydantic's ValidationError."""
    if isinstance(form, type) and issubclass(form, BaseModel):
        return form.model_validate(value, context=context)
    return _ADAPTERS.of(form).validate_python(value, context=context)


def core_schema_of(form: Any) -> CoreSchema:
    """Return pydantic's own schema of a form."""
    return _ADAPTERS.of(form).core_schema


class Lazy:
    """Declares a field whose module is imported when a recipe uses the key.

    ``randomize: Annotated[Any, Lazy("mjcompose.language.randomize:Randomize")] = None``
    """

    def __init__(self, target: str) -> None:
        self.target = target

    @property
    def form(self) -> Any:
        return loaded(self.target)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(
            lambda value, info: validated(self.form, value, info.context), metadata={ELSEWHERE: self}
        )

    def schema(self, generate: Callable[[CoreSchema], Schema]) -> Schema:
        """Return the JSON Schema of the form."""
        return generate(core_schema_of(self.form))


class Rows:
    """The words of a table are keys of the mapping; each row is the form of its value, or its `module:Name`.

    The field has an alias in angle brackets, for nobody writes it, and becomes a mapping from words to the values of
    their forms, in the order of the table. `table` returns the table, so it may be declared later. `selects` is
    the field that these values are about; they find it in the context, as `settings(context).selected`.

    ``verbs: Annotated[Mapping[str, Verb], Rows(lambda: VERBS, selects="select")] = Field({}, alias="<verbs>")``
    """

    is_rows = True

    def __init__(self, table: Callable[[], Table[Any]], *, selects: str | None = None) -> None:
        self.table, self.selects = table, selects

    def form(self, word: str) -> Any:
        """Return the form of a word's value."""
        return form_of(self.table()[word])

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read, metadata={ELSEWHERE: self})

    def schema(self, generate: Callable[[CoreSchema], Schema]) -> Schema:
        """Return the JSON Schema of each of our own words, described by the first line of its form."""
        found: dict[str, Schema] = {}
        for word in self.table().own:
            form = self.form(word)
            about = form.__doc__ if isinstance(form, type) and issubclass(form, BaseModel) else None
            described = {"description": first_line(about)} if about else {}
            found[word] = {**generate(core_schema_of(form)), **described}
        return found

    def _read(self, value: Mapping[str, Any], info: ValidationInfo) -> dict[str, Any]:
        context = settings(info.context)
        if self.selects is not None:
            context = replace(context, selected=info.data.get(self.selects))
        read: dict[str, Any] = {}
        errors: dict[str, ValidationError] = {}
        for word in sorted(value, key=list(self.table()).index):
            try:
                read[word] = validated(self.form(word), value[word], context)
            except ValidationError as error:
                errors[word] = error
        if errors:
            raise together(errors)
        return read
