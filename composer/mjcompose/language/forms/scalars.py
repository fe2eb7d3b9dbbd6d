"""Kinds of single values and lists: their annotations tell validator, messages and editors how to treat them."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Mapping
from typing import Annotated, Any, get_args

from pydantic import (
    BeforeValidator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
)
from pydantic_core import CoreSchema, PydanticKnownError, core_schema

from mjcompose.base.codes import CODES, RULES
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Fault, Note
from mjcompose.base.suggest import advised
from mjcompose.base.words import with_article
from mjcompose.language.element_schema import attribute_schema
from mjcompose.language.forms.context import (
    LIST,
    ByGrammar,
    Schema,
    Settings,
    computable,
    definition,
    reference,
    settings,
    validated_with,
    validation_error,
)
from mjcompose.language.forms.model import IT, KEY, OWNER
from mjcompose.language.select import GLOB, check_template, pattern_fault, read_selector
from mjcompose.language.value import bare_angle, is_unprintable, kind_of, odd_name, read_value, unprintable
from mjcompose.text.expression import Angle
from mjcompose.text.node import is_template
from mjcompose.tree.grammar import GRAMMAR, Attribute as Declared
from mjcompose.tree.pattern import Selector


class Expects(Struct):
    """The expected value, in messages and in editors; `example` is a written example."""

    what: str
    example: str | None = None

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        found = handler(schema)
        if found.get("type") in (LIST, "array", "string"):  # of a mapping it would be the message for each unknown key
            found["errorMessage"] = f"expected {self.what}" + (f", such as {self.example}" if self.example else "")
        return found


class NumberUnit(Struct):
    """The unit that a number is in: `kg`, `m`, `s`, `kg/m³`. It is never written; `90deg` is a `Measure`."""

    name: str


class Checked:
    """An annotation that checks a value: `fault` returns its fault, or None.

    The check follows the check of the value's type, unless it comes `first`; then pydantic does not check a value with
    a fault.

    >>> from pydantic import TypeAdapter
    >>> short = Checked(lambda text: Fault("bad-name", f"{IT} is too long") if len(text) > 3 else None)
    >>> TypeAdapter(Annotated[str, short]).validate_python("abc")
    'abc'
    """

    def __init__(self, fault: Callable[[Any], Fault | None], *, first: bool = False) -> None:
        self._fault = fault
        self._first = first

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        if self._first:
            return core_schema.no_info_before_validator_function(self._read, handler(source))
        return core_schema.no_info_after_validator_function(self._read, handler(source))

    def _read(self, value: Any) -> Any:
        fault = self._fault(value)
        if fault is not None:
            raise validation_error([fault], value)
        return value


class Name(Checked):
    """A name of an element: `scope` has the possible tags of the element, the likeliest first.

    With `glob`, it is a name, a glob or a regular expression. With `computed`, `${…}` is computed for each element.
    `inside` is the key of the mapping that names the part of the element, if the name is not from the whole model.
    A `new` name must fit on one line; other names may be of elements in a model that somebody else wrote.
    """

    def __init__(
        self,
        *scope: str,
        glob: bool = False,
        computed: bool = False,
        inside: str | None = None,
        what: str | None = None,
        new: bool = False,
    ) -> None:
        tags = " or ".join(map(with_article, scope))
        usual = (f"a glob over names: {tags}" if glob else f"the name of {tags}") if scope else "a name"
        self.scope = scope
        self.glob = glob
        self.computed = computed
        self.inside = inside
        self.what = what or usual
        self.new = new
        super().__init__(self._wrong)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        about = {key: each for key, each in handler(schema).items() if key == "description"}
        plain: Schema = {"type": "string", "minLength": 1, "errorMessage": f"expected {self.what}"}
        return {**(GLOB if self.glob else plain), **about}

    def _wrong(self, text: str) -> Fault | None:
        if not text:
            raise PydanticKnownError("string_too_short", {"min_length": 1})
        if self.new and (fault := odd_name(text, IT, ())) is not None:
            return fault
        if is_unprintable(text):
            return unprintable(IT, ())
        if self.computed and is_template(text):
            faults: list[Fault] = []
            check_template(text, (), faults)
            return faults[0] if faults else None
        return pattern_fault(text, OWNER, ()) if self.glob else None


class Measure:
    """A number that may have the unit of an angle, which is kept: `Annotated[float | Angle, Measure(ge=0)]`."""

    def __init__(self, *, ge: float | None = None, gt: float | None = None, le: float | None = None) -> None:
        self._ge = ge
        self._gt = gt
        self._le = le

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        return {**reference("number"), **{key: each for key, each in self.bounds.items() if each is not None}}

    @property
    def bounds(self) -> dict[str, float | None]:
        return {"minimum": self._ge, "exclusiveMinimum": self._gt, "maximum": self._le}

    def read(self, value: Any) -> float | Angle:
        """Return the written value, with its unit. Raises PydanticKnownError."""
        read = Angle.read(value) if isinstance(value, str) else value
        if isinstance(read, bool) or not isinstance(read, int | float | Angle):
            raise PydanticKnownError("float_type")
        number = read.value if isinstance(read, Angle) else read
        if not abs(number) <= sys.float_info.max:
            raise PydanticKnownError("finite_number")
        if self._ge is not None and number < self._ge:
            raise PydanticKnownError("greater_than_equal", {"ge": self._ge})
        if self._gt is not None and number <= self._gt:
            raise PydanticKnownError("greater_than", {"gt": self._gt})
        if self._le is not None and number > self._le:
            raise PydanticKnownError("less_than_equal", {"le": self._le})
        return read


class Scaled:
    """A number, or a number with one of the `units`, which are factors: `-1mm`, `20MB`.

    >>> from pydantic import TypeAdapter
    >>> TypeAdapter(Annotated[float, Scaled(LENGTHS)]).validate_python("-1mm")
    -0.001
    """

    def __init__(
        self, units: Mapping[str, float], *, ge: float | None = None, gt: float | None = None, le: float | None = None
    ) -> None:
        self._units = units
        self._measure = Measure(ge=ge, gt=gt, le=le)
        self._signed = ge is None and gt is None

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        sign = "-?" if self._signed else ""
        known = "|".join(self._units)
        return {
            **{key: each for key, each in self._measure.bounds.items() if each is not None},
            "type": ["number", "string"],
            "pattern": rf"^{sign}{_DIGITS}\s*(?:{known})$|\$\{{",
            "patternErrorMessage": f"expected a number, or one with a unit: {', '.join(self._units)}",
        }

    def _read(self, value: Any) -> float:
        match = _WITH_UNIT.fullmatch(value) if isinstance(value, str) else None
        if match is not None and match[2] in self._units:
            value = float(match[1]) * self._units[match[2]]
        elif isinstance(value, str):
            raise PydanticKnownError("float_type")
        return float(self._measure.read(value))  # type: ignore[arg-type]


_DIGITS = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_WITH_UNIT = re.compile(rf"(-?{_DIGITS})\s*([A-Za-z]+)")
LENGTHS: Mapping[str, float] = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
BYTES: Mapping[str, float] = {
    f"{prefix}{infix}B": float((1024 if infix else 1000) ** power)
    for power, prefix in enumerate("kMG", 1)
    for infix in ("", "i")
}


class Items:
    """A list of `least` to `most` values, read as a tuple; with `single`, one value is a list of one.

    `single` is the type of such a value, or True for the items' type.

    `Annotated[tuple[Glob, ...], Items(1, single=True)]` has its items' form in its own type.
    """

    def __init__(self, least: int = 0, most: int | None = None, *, single: Any = False, unique: bool = False) -> None:
        self.least = least
        self.most = most
        self._single = single
        self._unique = unique

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        item = handler.generate_schema(get_args(source)[0])
        # Not a tuple, which pydantic calls too short next to a wrong item.
        several: CoreSchema = core_schema.list_schema(item, min_length=self.least or None, max_length=self.most)
        if self._single:
            lone = item if self._single is True else handler.generate_schema(self._single)
            both = core_schema.union_schema([lone, several])
            several = core_schema.no_info_before_validator_function(
                lambda value: value if isinstance(value, list) else [value], several, json_schema_input_schema=both
            )
        return core_schema.no_info_after_validator_function(self._read, several)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        found = handler(schema)
        if self._unique:
            for each in (found, *found.get("anyOf", ())):
                if each.get("type") in (LIST, "array"):
                    each["uniqueItems"] = True
        return found

    def _read(self, items: list[Any]) -> tuple[Any, ...]:
        faults = [
            Fault("name-clash", f"`{each}` is in {IT} twice", (index,), help="take one out")
            for index, each in enumerate(items if self._unique else ())
            if each in items[:index]
        ]
        if faults:
            raise validation_error(faults, items)
        return tuple(items)


def whole(value: Any) -> Any:
    """Return a whole number as int: an expression computes 20.0 for 200 / 10, an integer for JSON Schema."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def in_order(pair: tuple[Any, ...]) -> Fault | None:
    (low, unit), (high, other) = (
        (each.value, each.unit) if isinstance(each, Angle) else (each, "") for each in (pair[0], pair[-1])
    )
    if unit != other or low <= high:
        return None
    message = f"{IT} starts with {low:g}{unit}, which is more than {high:g}{unit}"
    return Fault("out-of-range", message, help=f"write `{KEY}: [{high:g}{unit}, {low:g}{unit}]`")


Positive = Annotated[float, Field(gt=0)]
NotNegative = Annotated[float, Field(ge=0)]
# `BeforeValidator` comes after the bounds, which the JSON Schema has only then.
Whole = Annotated[int, BeforeValidator(whole)]
Count = Annotated[int, Field(ge=0), BeforeValidator(whole)]
AtLeastOne = Annotated[int, Field(ge=1), BeforeValidator(whole)]
Text = Annotated[str, Field(min_length=1)]
Range = Annotated[tuple[float, float], Items(2, 2), Checked(in_order), Expects("a list of 2 numbers", "[LOW, HIGH]")]
"""Two numbers, the lower one first."""


class Keys:
    """A check of the keys of a mapping: `fault` returns the fault of a key, or None; `schema` describes the keys."""

    def __init__(self, fault: Callable[[str, Settings], Fault | None], schema: Schema | None = None) -> None:
        self._fault = fault
        self._schema = schema

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_wrap_validator_function(self._read, handler(source))

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        return handler(schema) if self._schema is None else {**handler(schema), "propertyNames": self._schema}

    def _read(self, value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
        found = (self._fault(each, settings(info.context)) for each in (value if isinstance(value, dict) else ()))
        return validated_with(handler, value, [*filter(None, found)])


def _value_fault(value: Any) -> Fault | None:
    items = value if isinstance(value, list) else [value]
    if not any(isinstance(each, dict | list) or each is None for each in items):
        return None
    return Fault("wrong-type", f"{IT} expects a value or a list of values, got {kind_of(value)}")


VALUE: Schema = {"type": ["number", "boolean", "string", "array"], "items": {"type": ["number", "boolean", "string"]}}
Written = Annotated[Any, Checked(_value_fault), WithJsonSchema(VALUE)]
"""The value of a parameter: a number, a text, true or false, or a list of these."""

WHEN: Schema = {
    "anyOf": [{"type": "object"}, {"type": "boolean"}, {"type": "string", "pattern": r"\$\{"}],
    "description": "The builds that this belongs to: values of variants and parameters, or one boolean `${…}`.",
}
When = Annotated[Any, WithJsonSchema(WHEN)]
"""The condition of an item. `expand` decides it before the forms read a recipe."""
FOR: Schema = {
    "type": "object",
    "minProperties": 1,
    "additionalProperties": {
        "anyOf": [
            {"type": "integer", "minimum": 0},
            {"type": ["array", "object"]},
            {"type": "string", "pattern": r"\$\{"},
        ]
    },
    "description": "Names and their values: `{i: 3}`, `{side: [left, right]}`. The entry is repeated for each"
    " combination of these, with `${i}` in its values and in its key.",
}
Turns = Annotated[Any, WithJsonSchema(FOR)]
"""The names of a repeated entry and their values. `expand` repeats it before the forms read a recipe."""


class Hints:
    """A dictionary of words that are right in other places, with the help for each: an annotation of a `Literal`."""

    def __init__(self, elsewhere: Mapping[str, str]) -> None:
        self.elsewhere = elsewhere


class AttributeValue(ByGrammar):
    """The value of an attribute of an element, by the path of the element in the grammar.

    With `computed`, `${…}` is computed for each element, and a value that has it stays as it is written. Otherwise the
    value is the value in MJCF: a list is a tuple.

    ``pos: Annotated[Vector | None, Attribute("frame", "pos")] = None``
    """

    def __init__(self, element: str, name: str, *, computed: bool = False) -> None:
        self.element = element
        self.name = name
        self.computed = computed

    @property
    def declared(self) -> Declared:
        return GRAMMAR.element(self.element).attributes[self.name]

    @property
    def tag(self) -> str:
        return GRAMMAR.element(self.element).tag

    def schema(self) -> Schema:
        return attribute_schema(self.declared, self.tag)

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        if self.computed and _is_computed(value, faults):
            return value
        read = read_value(self.declared, value, (), owner=OWNER, faults=faults, tag=self.tag)
        if read is not None and not faults and not settings.bare_angles:
            bare = bare_angle(self.declared, read, None, at=(), owner=OWNER)
            faults += [bare] if bare is not None else []
        return value if self.computed else read


class Selects(ByGrammar):
    def schema(self) -> Schema:
        return reference("selector")

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Selector | None:
        return read_selector(value, (), f"`select` of {OWNER}", faults=faults)


def _is_computed(value: Any, faults: list[Fault]) -> bool:
    found = False
    items = enumerate(value) if isinstance(value, list) else ((None, value),)
    for index, each in items:
        if isinstance(each, str) and is_template(each):
            check_template(each, () if index is None else (index,), faults)
            found = True
    return found


ALLOW = "allow"


def _codes() -> list[str]:
    """Return the codes of builds, without the codes of the linter's rules, which a process may know, too."""
    return [code for code in CODES if code not in RULES]


def _code_fault(code: str) -> Fault | None:
    known = _codes()
    if code in known:
        return None
    help, fix = advised(code, known)
    note = Note("`mjcompose explain --codes` lists all codes")
    return Fault("wrong-keyword", f"the code `{code}` does not exist", notes=(note,), help=help, fix=fix)


definition("code")(lambda _: computable({"enum": _codes()}))
Code = Annotated[str, Checked(_code_fault), Expects("the code of a warning"), WithJsonSchema(reference("code"))]
Codes = Annotated[tuple[Code, ...], Items(1, unique=True), Expects("a list of codes of warnings", "[convert-loss]")]
