"""The forms of `params` and `matrix`, which are read before a recipe is validated."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Discriminator, Field, Tag, ValidationError, WithJsonSchema

from mjcompose.base.diagnostic import Diagnostic, Fault, Path, Span
from mjcompose.base.sink import Sink
from mjcompose.language.forms.context import Schema, Settings, reference, validated
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import VALUE, AtLeastOne, Checked, Expects, Hints, Items, Measure, Text, Written
from mjcompose.language.forms.translate import faults, report
from mjcompose.language.parameters import Parameter, in_unit, is_usable
from mjcompose.language.value import shown
from mjcompose.text.expression import ANGLE_PATTERN, UNITS, Angle, Value
from mjcompose.text.node import Mapping as Located, Node, is_template, locate, to_python

NO_EMIT = "remove it, and choose the output when you build: `--as models`, `--as worlds` or `--as union`"
"""What to write instead of `emit`, which `matrix` and `randomize` had."""


def _default_fault(value: Any) -> Fault | None:
    if not isinstance(value, str) or not is_template(value):
        return None
    help = "a default is a literal value; use the parameter where the value is needed"
    return Fault("wrong-type", f"{IT} cannot be an expression", help=help)


_NUMBER: Schema = {"type": ["number", "string"], "pattern": f"^{ANGLE_PATTERN}$"}
_ALONE: Schema = {**VALUE, "items": _NUMBER}
_DEFAULT: Schema = {
    **_ALONE, "pattern": r"^(?!.*\$\{)",
    "patternErrorMessage": "a default is a literal value: it cannot be an expression",
}  # fmt: skip
Values = Annotated[tuple[Written, ...], Items(1), Expects("a list of values", "[1, 2]")]
Bound = Annotated[float | Angle, Measure()]
_Cell = Annotated[dict[str, Written], Field(min_length=1), Expects("a mapping from axes to values", "{load: 1}")]
Combinations = Annotated[tuple[_Cell, ...], Items(), Expects("a list of mappings from axes to values", "[{load: 1}]")]

_SCHEMAS: Mapping[str, Schema] = {
    "bool": {"type": "boolean"}, "int": {"type": "integer"}, "float": _NUMBER, "string": {"type": "string"},
    "vector": {"type": "array", "items": _NUMBER},
}  # fmt: skip
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
            Literal["bool", "int", "float", "string", "vector"],
            Hints({"number": "float", "text": "string", "choice": "`choices: […]` lists the values of a choice"}),
        ]
        | None
    ) = None
    """the type of the value; by default the type of `default`"""
    default: Annotated[Written, Checked(_default_fault), WithJsonSchema(_DEFAULT)] | None = None
    """the value if you set none; if omitted, you must set one"""
    min: Bound | None = None
    """the smallest allowed value, of each component"""
    max: Bound | None = None
    """the largest allowed value, of each component"""
    choices: Values | None = None
    """the allowed values"""
    length: AtLeastOne | None = None
    """the length of a vector"""
    unit: Text | None = None
    """the unit, for readers; with `deg` or `rad` the parameter is an angle in every expression"""
    doc: str = ""
    """its purpose"""

    def contradictions(self, context: Settings) -> Iterator[Fault]:
        parameter = self.parameter("", Span("", 1, 1))
        for at, each in (("default", self.default), *(("choices", each) for each in self.choices or ())):
            if self.unit is None and parameter.is_angle and (bare := _bare_beside_angles(_of_value(each))) is not None:
                message = f"`{at}` of {IT} has numbers with a unit and {shown(bare)} without one"
                yield Fault("bare-angle", message, (at,), help=f"write `{shown(bare)}{parameter.unit}`")
                return
        for name in ("min", "max"):
            if isinstance(bound := _in_unit(getattr(self, name), parameter.unit), Angle):
                message = f"`{name}` of {IT} is an angle, but the parameter has no unit of angles"
                yield Fault("wrong-type", message, (name,), help=f"write `unit: {bound.unit}`")
                return
        if parameter.low is not None and parameter.high is not None and parameter.low > parameter.high:
            yield Fault("out-of-range", f"`max` of {IT} is below its `min`", ("max",))

    def parameter(self, name: str, span: Span) -> Parameter:
        """Return the parameter. Its default is as it is written, and may have a type that it does not allow."""
        sample = _of_value(self.default if self.default is not None else (self.choices or (None,))[0])
        guess, unit = _inferred(sample)
        unit = self.unit or (None if self.type == "string" else unit)
        low, high = (_in_unit(bound, unit) for bound in (self.min, self.max))
        length = len(sample) if isinstance(sample, tuple) else None
        return Parameter(
            name, self.type or guess, None if self.default is None else sample, span=span, low=low, high=high,
            choices=tuple(_in_unit(_of_value(each), unit) for each in self.choices or ()),
            length=self.length or length, unit=unit, doc=self.doc,
        )  # fmt: skip


def _of_value(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _inferred(sample: Value | None) -> tuple[str, str | None]:
    """Return the type and the unit of a parameter from its value.

    >>> _inferred(1), _inferred("90deg"), _inferred("left"), _inferred(("1rad", "2rad"))
    (('float', None), ('float', 'deg'), ('string', None), ('vector', 'rad'))
    """
    if isinstance(sample, tuple):
        angles = [each for each in map(_angle, sample) if each is not None]
        return "vector", angles[0].unit if angles else None
    if (angle := _angle(sample)) is not None:
        return "float", angle.unit
    return "string" if isinstance(sample, str) else "bool" if isinstance(sample, bool) else "float", None


def _angle(value: Any) -> Angle | None:
    return Angle.read(value) if isinstance(value, str) else value if isinstance(value, Angle) else None


def _bare_beside_angles(value: Any) -> int | float | None:
    """Return the first number of a vector that has no unit, although another one has; 0 needs none."""
    if not isinstance(value, tuple) or all(_angle(each) is None for each in value):
        return None
    numbers = (each for each in value if isinstance(each, int | float) and not isinstance(each, bool))
    return next((each for each in numbers if each != 0), None)


def _in_unit(value: Any, unit: str | None) -> Any:
    return value if unit is None or unit not in UNITS else in_unit(value, UNITS[unit])


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


_ABOUT = "The default alone, which determines the parameter's type."
_Value = Annotated[Written, WithJsonSchema({**_ALONE, "description": _ABOUT}), Tag("<value>")]
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
    _, section = document.entries["params"]
    if not isinstance(section, Located):
        help = "write `params: {reach: {default: 0.45, unit: m}}`"
        sink.error("wrong-type", "`params` is a mapping from names to parameters", section.span, help=help)
        return {}
    found: dict[str, Parameter] = {}
    for key, node in section.entries.values():
        if not is_usable(key, "a parameter", sink):
            continue
        data = to_python(node) if isinstance(node, Located) else {"default": to_python(node)}
        declared = read(Declaration, data, document, at=("params", key.name), sink=sink)
        if declared is None:
            continue
        parameter = declared.parameter(key.name, key.span)
        settled = None if parameter.default is None else parameter.read(parameter.default)
        if isinstance(settled, Diagnostic):
            sink.add(replace(settled, span=locate(document, ("params", key.name, "default"))))
        else:
            found[key.name] = replace(parameter, default=settled)
    return found


def read_grid(document: Located, sink: Sink) -> Grid | None:
    found: Grid | None = read(Grid, to_python(document.entries["matrix"][1]), document, at=("matrix",), sink=sink)
    return found


def read(form: type[Model], data: Any, document: Node, *, at: Path, sink: Sink) -> Any:
    """Return the value that a form reads at a path, or None after its faults are reported at their places."""
    try:
        return validated(form, data, Settings())
    except ValidationError as error:
        report(faults(error, form, data, start=at), document, sink)
        return None
