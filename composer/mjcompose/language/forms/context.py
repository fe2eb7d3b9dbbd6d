"""The common context of validations: settings, faults as errors of pydantic, and definitions of the JSON Schema."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import deepcopy
from typing import Any

from pydantic import (
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
)
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError, core_schema

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault
from mjcompose.base.suggest import closest
from mjcompose.tree.pattern import Selector

Schema = dict[str, Any]


REFERENCE = "mjcf"


_DEFINITIONS: dict[str, Callable[[str], Schema]] = {}


def definition(kind: str) -> Callable[[Callable[[str], Schema]], Callable[[str], Schema]]:
    """Return a decorator for the function that makes the definition `KIND:NAME`, or `KIND-NAME`, of a name.

    The function gets an empty name if the reference is only `KIND`.
    """

    def register(make: Callable[[str], Schema]) -> Callable[[str], Schema]:
        if kind in _DEFINITIONS:
            raise TypeError(f"two functions make the definition {kind}")
        _DEFINITIONS[kind] = make
        return make

    return register


@definition("made")
def _made(name: str) -> Schema:
    """Return a reference to a definition derived from the whole schema: `InPlace`, `Piece`."""
    return {"$ref": f"#/$defs/{name}"}


def define(name: str) -> Schema:
    """Return the schema that a reference leads to; the caller may change it. Raises KeyError for an unknown one."""
    kind, _, rest = name.partition(":" if ":" in name else "-")
    return deepcopy(_DEFINITIONS[kind](rest))


def reference(name: str) -> Schema:
    """Return a reference to a definition. It is not `$ref`, whose target pydantic would want to know."""
    return {REFERENCE: name}


def definition_key(name: str) -> str:
    """Return the key of a definition in `$defs`.

    >>> definition_key("variant:sensor/force")
    'variant.sensor.force'
    """
    return name.replace(":", ".").replace("/", ".")


DEFAULT_SEPARATOR = "/"


@dataclass(frozen=True, slots=True)
class Settings:
    """The context of a validation.

    With `bare_angles`, angles without a unit are allowed. `separator` is between a prefix and a name. `selected` is
    the selector that the values of an entry of `edit` are about, None if it has a fault.
    """

    bare_angles: bool = True
    separator: str = DEFAULT_SEPARATOR
    selected: Selector | None = None

    @classmethod
    def of(cls, data: object) -> Settings:
        """Return the settings of the top-level keys of a recipe. One that is wrong or misspelled counts as given."""
        if not isinstance(data, Mapping):
            return cls()
        separator = data.get("separator", DEFAULT_SEPARATOR)
        bare_angles = any(key == "angle" or closest(str(key), ["angle"]) for key in data)
        return cls(bare_angles, separator if isinstance(separator, str) and separator else DEFAULT_SEPARATOR)


_LENIENT = Settings()


def settings(context: Any) -> Settings:
    """Return the settings in a pydantic context, or lenient ones if there are none."""
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
    """Return one exception for those of several keys of a mapping."""
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
    """Return an error of `errors()` in a form that can be raised."""
    kind = error["type"]
    context = error.get("ctx", {})
    if kind == "fault":
        kind = PydanticCustomError("fault", "{message}", context)
    return InitErrorDetails(type=kind, loc=error["loc"], input=error["input"], ctx=context)


class ByGrammar(ABC):
    """An annotation of a field whose value the grammar of MJCF reads: elements, attributes and selectors.

    ``sensor: Annotated[tuple[Element, ...], Typed("sensor")] = ()``
    """

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
