"""The common context of validations: settings, faults as errors of pydantic, and definitions of the JSON Schema."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import Any

from pydantic import (
    BaseModel,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
)
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, core_schema

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import ExtensionTable
from mjcompose.base.suggest import closest
from mjcompose.language.forms.source_text import text_of
from mjcompose.tree.pattern import Selector

Schema = dict[str, Any]

REFERENCE = "mjcf"

_DEFINITIONS: dict[str, Callable[[str], Schema]] = {}


def definition(kind: str) -> Callable[[Callable[[str], Schema]], Callable[[str], Schema]]:
    """Return a decorator for the function that makes the definition `KIND:NAME`, `KIND-NAME` or `KIND` of a name."""

    def register(make: Callable[[str], Schema]) -> Callable[[str], Schema]:
        if kind in _DEFINITIONS:
            raise TypeError(f"two functions make the definition {kind}")
        _DEFINITIONS[kind] = make
        return make

    return register


definition("made")(lambda name: {"$ref": f"#/$defs/{name}"})  # derived from the whole schema


def define(name: str) -> Schema:
    kind, _, rest = name.partition(":" if ":" in name else "-")
    return deepcopy(_DEFINITIONS[kind](rest))


LIST = ["array", "string"]
"""The type of a list that may also be a `${…}` that gives it."""


def computable(schema: Schema) -> Schema:
    """Return the schema of a value that may also be a `${…}` that gives it."""
    about = {key: schema[key] for key in ("description",) if key in schema}
    return {"anyOf": [{key: each for key, each in schema.items() if key not in about}, reference("template")], **about}


def reference(name: str) -> Schema:
    """Return a reference to a definition. It is not `$ref`, whose target pydantic would look up."""
    return {REFERENCE: name}


def definition_key(name: str) -> str:
    """Return the key of a definition in `$defs`.

    >>> definition_key("variant:sensor/force")
    'variant.sensor.force'
    """
    return name.replace(":", ".").replace("/", ".")


DEFAULT_SEPARATOR = "/"


class Settings(Struct):
    """The context of a validation.

    With `bare_angles`, angles without a unit are allowed. `separator` is between a prefix and a name. `selected` is
    the selector that the values of an entry of `edit` are about, None if it has a fault.
    """

    bare_angles: bool = True
    separator: str = DEFAULT_SEPARATOR
    selected: Selector | None = None

    @classmethod
    def of(cls, data: object) -> Settings:
        """Return the settings of the top-level keys of a recipe. A wrong or misspelled key counts as given."""
        if not isinstance(data, Mapping):
            return cls()
        separator = data.get("separator", DEFAULT_SEPARATOR)
        bare_angles = any(key == "angle" or closest(str(key), ["angle"]) for key in data)
        return cls(bare_angles, separator if isinstance(separator, str) and separator else DEFAULT_SEPARATOR)


_LENIENT = Settings()


def settings(context: Any) -> Settings:
    return context if isinstance(context, Settings) else _LENIENT


def validation_error(faults: Sequence[Fault], value: object) -> ValidationError:
    """Return one exception for all faults of a value. Pydantic puts the path of the value in front of each `at`."""
    return ValidationError.from_exception_data("recipe", _lines(faults, value))


def validated_with(handler: ValidatorFunctionWrapHandler, value: Any, faults: Sequence[Fault]) -> Any:
    """Return the result of pydantic's handler. Raise its errors and the faults together, if there are any."""
    try:
        result = handler(value)
    except ValidationError as error:
        if not faults:
            raise
        known = [_again(each) for each in error.errors(include_url=False)]
        raise ValidationError.from_exception_data("recipe", [*known, *_lines(faults, value)]) from None
    if faults:
        raise validation_error(faults, value)
    return result


def together(errors: Mapping[str, ValidationError]) -> ValidationError:
    lines = [
        _again({**each, "loc": (key, *each["loc"])})
        for key, error in errors.items()
        for each in error.errors(include_url=False)
    ]
    return ValidationError.from_exception_data("recipe", lines)


def _lines(faults: Iterable[Fault], value: object) -> list[InitErrorDetails]:
    return [
        InitErrorDetails(
            # Not the message itself: for pydantic it is a template, in which it would replace braces.
            type=PydanticCustomError("fault", "{message}", {"message": fault.message, "fault": fault}),
            loc=fault.at,
            input=value,
        )
        for fault in faults
    ]


def _again(error: Any) -> InitErrorDetails:
    kind = error["type"]
    context = error.get("ctx", {})
    if kind == "fault":
        kind = PydanticCustomError("fault", "{message}", context)
    return InitErrorDetails(type=kind, loc=error["loc"], input=error["input"], ctx=context)


class ByGrammar(ABC):
    """An annotation of a field that the grammar of MJCF reads: `sensor: Annotated[…, Typed("sensor")]`."""

    @abstractmethod
    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        """Return the value of the field. Faults, with paths below it, go to `faults` and make the value void."""

    @abstractmethod
    def schema(self) -> Schema:
        """Return the JSON Schema of what you may write."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        return self.schema()

    def _validate(self, value: Any, info: ValidationInfo) -> Any:
        faults: list[Fault] = []
        read = self.read(value, faults, settings(info.context))
        if faults:
            raise validation_error(faults, value)
        return read


ELSEWHERE = "mjcompose"
"""The key of pydantic's metadata for forms declared elsewhere: `Generator` asks them for their JSON Schema."""


@cache
def loaded(target: str) -> Any:
    """Import the object that `module:Name` names.

    >>> loaded("mjcompose.language.forms.context:Lazy").__name__
    'Lazy'
    """
    module, _, name = target.partition(":")
    return getattr(import_module(module), name)


def first_line(text: str) -> str:
    return " ".join(text.partition("\n\n")[0].split())


_ADAPTERS: dict[int, tuple[Any, TypeAdapter[Any]]] = {}
"""The validators of forms, which have no hash, each built on first use."""


def _adapter(form: Any) -> TypeAdapter[Any]:
    if id(form) not in _ADAPTERS:
        _ADAPTERS[id(form)] = form, TypeAdapter(form)
    return _ADAPTERS[id(form)][1]


def validated(form: Any, value: Any, context: Any = None) -> Any:
    if isinstance(form, type) and issubclass(form, BaseModel):
        return form.model_validate(value, context=context)
    return _adapter(form).validate_python(value, context=context)


class Lazy:
    """Declares a field whose module is imported when a recipe uses the key, by `module:Name`."""

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
        return generate(_adapter(self.form).core_schema)


class Rows:
    """Makes the words of a table keys of the mapping. Each row is the form of the value, or its `module:Name`.

    The field has an alias in angle brackets, because nobody writes it, and becomes a mapping from words to the values
    of their forms, in the order of the table. `table` returns the table, so it may be declared later. `selects` is the
    field that these values are about; they find it in the context, as `settings(context).selected`.

    ``verbs: Annotated[Mapping[str, Verb], Rows(lambda: VERBS, selects="select")] = Field({}, alias="<verbs>")``
    """

    is_rows = True

    def __init__(self, table: Callable[[], ExtensionTable[Any]], *, selects: str | None = None) -> None:
        self.table = table
        self.selects = selects

    def form(self, word: str) -> Any:
        row = self.table()[word]
        return loaded(row) if isinstance(row, str) else row

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read, metadata={ELSEWHERE: self})

    def schema(self, generate: Callable[[CoreSchema], Schema]) -> Schema:
        """Return the JSON Schema of each of our own words, described by the first line of its form."""
        found: dict[str, Schema] = {}
        for word in self.table().own:
            form = self.form(word)
            about = text_of(form) if isinstance(form, type) and issubclass(form, BaseModel) else ""
            described = {"description": first_line(about)} if about else {}
            found[word] = {**generate(_adapter(form).core_schema), **described}
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
