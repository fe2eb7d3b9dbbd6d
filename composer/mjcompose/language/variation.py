"""The forms of `params` and `matrix`, which are read before a recipe is validated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, ValidationError, WithJsonSchema

from mjcompose.base.diagnostic import Diagnostic, Fault, Path, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import closest
from mjcompose.base.words import value_text
from mjcompose.language.forms.context import Schema, Settings, reference, validated
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import VALUE, AtLeastOne, Checked, Expects, Hints, Items, Measure, Text, Written
from mjcompose.language.forms.translate import faults, report
from mjcompose.language.parameters import Parameter, in_unit, is_usable, plain
from mjcompose.text.expression import ANGLE_PATTERN, UNITS, Angle, DataTable, Value
from mjcompose.text.node import Mapping as Located, Node, find, is_template, locate, to_python

NO_EMIT = "remove it, and choose the output when you build: `--as models`, `--as worlds` or `--as union`"
"""What to write instead of `emit`, which `matrix` and `randomize` had."""


def _default_fault(value: Any, at: Path = ()) -> Fault | None:
    if isinstance(value, dict | list):
        inside = value.items() if isinstance(value, dict) else enumerate(value)
        return next(filter(None, (_default_fault(each, (*at, step)) for step, each in inside)), None)
    if value is None:
        return Fault("wrong-type", f"a value of {IT} is missing", at)
    if not isinstance(value, str) or not is_template(value):
        return None
    help = "a default is a literal value; use the parameter where the value is needed"
    return Fault("wrong-type", f"{IT} cannot be an expression", at, help=help)


_NUMBER: Schema = {"type": ["number", "string"], "pattern": f"^{ANGLE_PATTERN}$"}
_LITERAL: Schema = {
    "pattern": r"^(?!.*\$\{)",
    "patternErrorMessage": "a default is a literal value: it cannot be an expression",
}
_ALONE: Schema = {**VALUE, "items": {"not": {"type": "null"}}}
_DEFAULT: Schema = {**_ALONE, "type": [*VALUE["type"], "object"], **_LITERAL}
_Data = Annotated[Any, Checked(_default_fault)]
"""A literal value of any kind: a list and a table may have lists and tables inside."""
Values = Annotated[tuple[Written, ...], Items(1), Expects("a list of values", "[1, 2]")]
Bound = Annotated[float | Angle, Measure()]
_Cell = Annotated[dict[str, Written], Field(min_length=1), Expects("a mapping from axes to values", "{load: 1}")]
Combinations = Annotated[tuple[_Cell, ...], Items(), Expects("a list of mappings from axes to values", "[{load: 1}]")]

_SCHEMAS: Mapping[str, Schema] = {
    "bool": {"type": "boolean"},
    "int": {"type": "integer"},
    "float": _NUMBER,
    "string": {"type": "string"},
    "vector": {"type": "array", "items": _NUMBER},
    "list": {"type": "array"},
    "table": {"type": "object"},
}
"""The possible defaults of a parameter, by its type."""


class _Typed:
    def faults(self, value: Mapping[str, Any], model: type[Model], context: Settings) -> Iterator[Fault]:
        if value.keys().isdisjoint(("default", "type", "choices")):
            help = "write `{default: …}`, or `{type: float}` for one that must be given"
            yield Fault("missing-key", f"{IT} has neither `default` nor `type`", key=True, help=help)

    def schema(self) -> Iterator[Schema]:
        none = dict.fromkeys(("default", "type", "choices"), False)
        needed = {"required": ["default"], "errorMessage": "write `default`, or `type: float`"}
        yield {"if": {"properties": none}, "then": needed}
        for word, kind in _SCHEMAS.items():
            yield {
                "if": {"properties": {"type": {"const": word}}, "required": ["type"]},
                "then": {"properties": {"default": {**kind, "description": "its value where none is given"}}},
            }


class Declaration(Model):
    """A parameter with its bounds; a single value is its default."""

    rules: ClassVar = (_Typed(),)
    example: ClassVar = "{default: 0.45, unit: m}"
    called: ClassVar = "parameter `{}`"

    type: (
        Annotated[
            Literal["bool", "int", "float", "string", "vector", "list", "table"],
            Hints(
                {
                    "number": "float",
                    "text": "string",
                    "mapping": "table",
                    "dict": "table",
                    "choice": "`choices: […]` lists the values of a choice",
                }
            ),
        ]
        | None
    ) = None
    """the type of the value; by default the type of `default`"""
    default: Annotated[_Data, WithJsonSchema(_DEFAULT)] | None = None
    """the value if you set none; if omitted, you must set one"""
    min: Bound | None = None
    """the smallest allowed value, of each number"""
    max: Bound | None = None
    """the largest allowed value, of each number"""
    choices: Values | None = None
    """the allowed values"""
    length: AtLeastOne | None = None
    """the length of a vector or a list"""
    columns: Annotated[tuple[Text, ...], Items(1), Expects("a list of names", "[kp, kd]")] | None = None
    """the columns of each row of a table; by default the columns of its first row"""
    unit: Text | None = None
    """the unit, for readers; with `deg` or `rad` the parameter is an angle in every expression"""
    doc: str = ""
    """its purpose"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        parameter = self.parameter("", Span("", 1, 1))
        for at, value in (("default", self.default), *(("choices", value) for value in self.choices or ())):
            if self.unit is None and parameter.is_angle and (bare := _bare_beside_angles(_of_value(value))) is not None:
                message = f"`{at}` of {IT} has numbers with a unit and {value_text(bare)} without one"
                yield Fault("bare-angle", message, (at,), help=f"write `{value_text(bare)}{parameter.unit}`")
                return
        for name in ("min", "max"):
            bound = _in_unit(getattr(self, name), parameter.unit)
            if isinstance(bound, Angle):
                message = f"`{name}` of {IT} is an angle, but the parameter has no unit of angles"
                yield Fault("wrong-type", message, (name,), help=f"write `unit: {bound.unit}`")
                return
        if self.columns is not None and parameter.type != "table":
            yield Fault("wrong-type", f"{IT} is not a table, so it has no `columns`", ("columns",), key=True)
        if parameter.low is not None and parameter.high is not None and parameter.low > parameter.high:
            yield Fault("out-of-range", f"`max` of {IT} is below its `min`", ("max",))

    def parameter(self, name: str, span: Span) -> Parameter:
        """Return the parameter. Its default is as it is written, and may have a type that it does not allow."""
        sample = _of_value(self.default if self.default is not None else (self.choices or (None,))[0])
        guess, unit = _inferred(sample)
        unit = self.unit or (None if self.type in ("string", "list", "table") else unit)
        low, high = (_in_unit(bound, unit) for bound in (self.min, self.max))
        type = self.type or guess
        length = len(sample) if isinstance(sample, tuple) and type == "vector" else None
        return Parameter(
            name,
            type,
            None if self.default is None else sample,
            span=span,
            low=low,
            high=high,
            choices=tuple(_in_unit(_of_value(each), unit) for each in self.choices or ()),
            length=self.length or length,
            unit=unit,
            doc=self.doc,
            columns=self.columns,
        )


def _of_value(value: Any) -> Any:
    if isinstance(value, dict):
        return DataTable({name: _of_value(each) for name, each in value.items()})
    return tuple(map(_of_value, value)) if isinstance(value, list) else value


def _inferred(sample: Value | None) -> tuple[str, str | None]:
    """Return the type and the unit of a parameter from its value.

    >>> _inferred(1), _inferred("90deg"), _inferred("left"), _inferred(("1rad", "2rad")), _inferred((1, "left"))
    (('float', None), ('float', 'deg'), ('string', None), ('vector', 'rad'), ('list', None))
    """
    if isinstance(sample, DataTable):
        return "table", None
    if isinstance(sample, tuple):
        angles = [angle for angle in map(_angle, sample) if angle is not None]
        if len(angles) < len(sample) and not all(_is_number(item) for item in sample if _angle(item) is None):
            return "list", None
        return "vector", angles[0].unit if angles else None
    angle = _angle(sample)
    if angle is not None:
        return "float", angle.unit
    return "string" if isinstance(sample, str) else "bool" if isinstance(sample, bool) else "float", None


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _angle(value: Any) -> Angle | None:
    return Angle.read(value) if isinstance(value, str) else value if isinstance(value, Angle) else None


def _bare_beside_angles(value: Any) -> int | float | None:
    """Return the first number of a vector that has no unit, although another one has; 0 needs none."""
    if not isinstance(value, tuple) or all(_angle(each) is None for each in value):
        return None
    return next((each for each in value if _is_number(each) and each != 0), None)


def _in_unit(value: Any, unit: str | None) -> Any:
    return value if unit is None or unit not in UNITS else in_unit(value, UNITS[unit])


_Weight = Annotated[float, Measure(ge=0)]
_WEIGHTS = Expects("a mapping from axes to weights of their values", "{gripper: {large: 3}}")


class Grid(Model):
    """The combinations that `build --all` builds."""

    example: ClassVar = "{axes: {gripper: [small, large]}}"
    instead: ClassVar = {"emit": NO_EMIT}
    owned: ClassVar = "the matrix"

    axes: Annotated[dict[str, Values], Expects("a mapping from variants and parameters to lists of values")] = Field(
        examples=["{gripper: [small, large]}"]
    )
    """The values of each variant or parameter. `build --all` builds every combination."""
    exclude: Combinations = ()
    """Combinations to leave out of the build."""
    include: Combinations = ()
    """More combinations."""
    name: Text | None = None
    """The name of a combination, with `${…}` for its values."""
    weights: Annotated[dict[str, dict[str, _Weight]], _WEIGHTS] = Field(
        default_factory=dict, examples=["{gripper: {large: 3}}"]
    )
    """How many worlds `study.assign` gives to each cell, by axis and value. Other values have the weight 1."""


_ABOUT = "The default alone, which determines the parameter's type."
_Value = Annotated[_Data, WithJsonSchema({**_ALONE, "description": _ABOUT}), Tag("<value>")]
_Parameter = Annotated[
    Annotated[Declaration, Tag("<mapping>")] | _Value,
    Discriminator(lambda value: "<mapping>" if isinstance(value, dict | Declaration) else "<value>"),
]
_EXPECTS = Expects("a mapping from names to parameters", "{reach: {default: 0.45, unit: m}}")
Params = Annotated[dict[str, _Parameter], _EXPECTS]
_Piece = Annotated[dict[str, Any], WithJsonSchema(reference("made:Piece"))]
Variants = dict[str, Annotated[dict[str, _Piece], Field(min_length=1)]]


def _computed(text: str) -> Fault | None:
    message = f"{IT} is read before any parameter is known"
    return Fault("expression", message, help="write the text itself") if is_template(text) else None


_Plain = Annotated[str, Field(min_length=1), Checked(_computed)]


def _wide(text: str) -> Fault | None:
    if text.strip("/:+@#").lower() not in ("", "http", "https", "git+https", "git+ssh"):
        return None
    help = "name what you trust: `git+file:///srv/robots`, `package:NAME`"
    return Fault("source-outside", f"`{text}` in {IT} would allow everything", help=help)


class TrustKeys(Model):
    """Folders and references on this machine and its network that you open to others."""

    example: ClassVar = "{files: [FOLDER]}"

    files: Annotated[tuple[_Plain, ...], Items(), Expects("a list of folders", "[FOLDER]")] = ()
    """Folders outside the project that models may read, relative to the recipe."""
    references: Annotated[
        tuple[Annotated[_Plain, Checked(_wide)], ...], Items(), Expects("a list of texts", "[REFERENCE]")
    ] = ()
    """References to this machine and its network that fetched recipes may use, by their beginning:
    `git+file:///srv/robots` or `package:NAME`."""


def read_params(document: Located, sink: Sink) -> dict[str, Parameter]:
    """Return the declared parameters, without faulty ones, which are reported."""
    _, section = document.entries["params"]
    if not isinstance(section, Located):
        help = "write `params: {reach: {default: 0.45, unit: m}}`"
        sink.error("wrong-type", "`params` is a mapping from names to parameters", section.span, help=help)
        return {}
    parameters: dict[str, Parameter] = {}
    for key, node in section.entries.values():
        if not is_usable(key, "a parameter", sink):
            continue
        if isinstance(node, Located) and _is_table(node):
            help = f"write it as its default: `{key.name}: {{default: {{{next(iter(node.entries))}: …}}}}`"
            sink.error("missing-key", f"parameter `{key.name}` is a table without `default`", key.span, help=help)
            continue
        data = to_python(node) if isinstance(node, Located) else {"default": to_python(node)}
        declared = read(Declaration, data, document, at=("params", key.name), sink=sink)
        if declared is None:
            continue
        parameter = declared.parameter(key.name, key.span)
        default = find(node, ("default",)) if isinstance(node, Located) else node
        if default is not None:
            parameter = replace(parameter, default=plain(default))  # which has the places of rows
        settled = None if parameter.default is None else parameter.read(parameter.default)
        if isinstance(settled, Diagnostic):
            span = settled.span or locate(document, ("params", key.name, "default"))
            sink.add(replace(settled, span=span))
        else:
            parameters[key.name] = replace(parameter, default=settled)
    return parameters


def _is_table(node: Located) -> bool:
    """Return whether a mapping has rows, and no key of a parameter or a word like one."""
    known = Declaration.key_names()
    return bool(node.entries) and not any(name in known or closest(name, known) for name in node.entries)


def read_grid(document: Located, sink: Sink) -> Grid | None:
    """Return the section `matrix`, or None after its faults are reported."""
    found: Grid | None = read(Grid, to_python(document.entries["matrix"][1]), document, at=("matrix",), sink=sink)
    return found


def read(form: type[Model], data: Any, document: Node, *, at: Path, sink: Sink) -> Any:
    """Return the value that a form reads at a path, or None after its faults are reported at their places."""
    try:
        return validated(form, data, Settings())
    except ValidationError as error:
        report(faults(error, form, data, start=at), document, sink)
        return None
