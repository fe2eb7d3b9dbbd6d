"""The form of a value in a recipe: how it is read, its faults, its JSON Schema."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import deepcopy
from dataclasses import field
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
from mjcompose.base.diagnostic import Diagnostic, Fault, Fix, Path
from mjcompose.base.suggest import advised, closest, exists_note
from mjcompose.model.grammar import number_text
from mjcompose.model.selector import Selector
from mjcompose.text.expression_values import Angle

__all__ = ["EXCLUSIVE", "Fault", "Path", "fault_at", "unknown_key", "validated_with", "validation_error"]

# Two keys exclude each other.
EXCLUSIVE = "wrong-type"


def fault_at(
    diagnostic: Diagnostic, at: Path, *, key: bool = False, help: str | None = None, fix: Fix | None = None
) -> Fault:
    """Return a diagnostic as a fault at a path. `help` and `fix` replace those of the diagnostic."""
    names = tuple(sorted(diagnostic.subjects))
    fix = fix if help else diagnostic.fix
    help = help or diagnostic.help
    return Fault(
        diagnostic.code, diagnostic.message, at, key=key, notes=diagnostic.notes, help=help, names=names, fix=fix
    )


def unknown_key(message: str, name: str, known: Iterable[str], at: Path, *, noun: str = "key") -> Fault:
    """Return the fault of an unknown key. `known` are the allowed keys, which messages call a `noun`."""
    known = list(known)
    help, fix = advised(name, known)
    note = exists_note(noun, known, name)
    return Fault("unknown-key", message, at, key=True, notes=(note,), help=help, fix=fix)


def validation_error(faults: Sequence[Fault], value: object) -> ValidationError:
    """Return one exception for all faults of a value. Pydantic puts the path of the value in front of each `at`."""
    return ValidationError.from_exception_data("recipe", _lines(faults, value))


def validated_with(handler: ValidatorFunctionWrapHandler, value: Any, faults: Sequence[Fault]) -> Any:
    """Return what pydantic's handler returns. Raise its errors and the faults together, if there are any."""
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


def shown(value: object) -> str:
    """Return a value as YAML on one line.

    >>> shown([0, "90deg", 1.5])
    '[0, 90deg, 1.5]'
    """
    if isinstance(value, list | tuple):
        return f"[{', '.join(shown(item) for item in value)}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return number_text(value) if isinstance(value, int | float) else str(value)


def kind_of(value: object) -> str:
    """Return the kind of a value, with the value itself if it is short: `text `abc``, `a list`."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    if value is None:
        return "nothing"
    kind = "text" if isinstance(value, str) else "a boolean" if isinstance(value, bool) else "a number"
    text = shown(value)
    if isinstance(value, float) and text.removeprefix("-").isdigit():
        text += ".0"  # what is expected may be a whole number, which this is not
    return f"{kind} `{text}`" if len(text) <= 40 and "\n" not in text else kind


def check_rows(table: str, rows: Iterable[object], members: Iterable[object]) -> None:
    """Raise TypeError if the rows of a table are not exactly the members.

    >>> check_rows("words", ["set", "scale"], ["set", "scale"])
    >>> check_rows("words", ["set"], ["set", "scale"])
    Traceback (most recent call last):
    TypeError: words: no row for scale
    """
    rows, members = list(rows), list(members)
    missing = [_name(each) for each in members if each not in rows]
    unknown = [_name(each) for each in rows if each not in members]
    faults = [f"no row for {', '.join(missing)}"] if missing else []
    faults += [f"a row for {', '.join(unknown)}, which does not exist"] if unknown else []
    if faults:
        raise TypeError(f"{table}: {'; '.join(faults)}")


def _name(member: object) -> str:
    return member.__name__ if isinstance(member, type) else str(member)


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


SCHEMAS: dict[str, Schema] = {
    "expect": {**reference("integer"), "minimum": 0, "description": "how many elements must be selected"},
    "optional": {"type": "boolean", "description": "whether it may be that nothing is selected"},
}
COUNT = tuple(SCHEMAS)


def read_count(value: dict[str, Any], at: Path, faults: list[Fault], owner: str = "") -> tuple[int | None, bool]:
    """Return the number, None for at least one, and whether none is allowed. `owner` is the subject of messages."""
    expect, optional = value.get("expect"), value.get("optional", False)
    of = f" of {owner}" if owner else ""
    if "expect" in value and (isinstance(expect, bool) or not isinstance(expect, int) or expect < 0):
        message = f"`expect`{of} is how many elements there must be, a whole number, got {kind_of(expect)}"
        faults.append(Fault("wrong-type", message, (*at, "expect")))
        expect = None
    if not isinstance(optional, bool):
        message = f"`optional`{of} is `true` or `false`, got {kind_of(optional)}"
        faults.append(Fault("wrong-type", message, (*at, "optional")))
    return expect, bool(optional)


Single = bool | int | float | str | Angle
Value = Single | tuple[Single, ...]


@dataclass(frozen=True, slots=True)
class Element:
    """An element with its children, and its attributes in the order of the file.

    `at` is its path from the top of the recipe: `locate(node, at)` is its place, and `locate(node, (*at, name))`
    that of an attribute. An element that the recipe names by its key has that name as its attribute `name`, whose
    place is `locate(node, at, key=True)`.

    With `xml`, the element is that fragment of MJCF, checked against the grammar and kept as text. Then `tag` is
    that of the fragment, there are no `children`, and `attributes` has at most the name that a key gives. Paths of
    files are relative to the recipe.
    """

    tag: str
    attributes: Mapping[str, Value] = field(default_factory=dict)
    children: tuple[Element, ...] = ()
    xml: str | None = None
    at: Path = ()


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


@dataclass(frozen=True, slots=True)
class Form(ABC):
    """An annotation for a field of a pydantic model, such as `seed: Annotated[int, Whole("seed", 0, 9)]`."""

    @abstractmethod
    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        """Return the value of the field. Faults are added to `faults`, with paths below it, and make the value void."""

    @abstractmethod
    def schema(self) -> Schema:
        """Return the JSON Schema of what may be written."""

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


# Characters that no XML file can contain, not even escaped.
_UNPRINTABLE = frozenset(map(chr, (*range(9), 11, 12, *range(14, 32), 0xFFFE, 0xFFFF, *range(0xD800, 0xE000))))


def is_unprintable(text: str) -> bool:
    """Return whether a text has a character that XML cannot contain."""
    return not _UNPRINTABLE.isdisjoint(text)


def unprintable(subject: str, at: Path, *, key: bool = False, name: bool = True) -> Fault:
    """Return the fault of a text with such a character."""
    return Fault("bad-name" if name else "wrong-type", f"{subject} has a character that XML cannot hold", at, key=key)


@dataclass(frozen=True, slots=True)
class Text(Form):
    """Form of a text of at least one character. `key` is its name in messages.

    `check` may find further faults.
    """

    key: str
    empty: bool = False
    check: Callable[[str], Fault | None] | None = None

    def schema(self) -> Schema:
        return {"type": "string"} if self.empty else {"type": "string", "minLength": 1}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> str:
        fault = self.fault(value)
        faults += [] if fault is None else [fault]
        return str(value)

    def fault(self, value: Any) -> Fault | None:
        if not isinstance(value, str):
            help = None if isinstance(value, list | dict) or value is None else f"quote it: '{shown(value)}'"
            return Fault("wrong-type", f"`{self.key}` expects text, got {kind_of(value)}", help=help)
        if not value and not self.empty:
            return Fault("wrong-type", f"`{self.key}` is empty")
        if is_unprintable(value):
            return unprintable(f"`{self.key}`", ())
        return None if self.check is None else self.check(value)
