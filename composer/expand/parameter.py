"""A parameter: its type, its default, and its possible values."""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.diagnostics.suggest import did_you_mean
from composer.expr.angle import Angle
from composer.expr.value import Value, kind, shown

TYPES = ("bool", "int", "float", "string", "vector")


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of a recipe.

    `low` and `high` bound numbers and every component of a vector; a parameter with `default` None must be given.
    `unit` is for readers, except `deg` and `rad`: a value that is only `${name}` is then an angle with that unit.
    """

    name: str
    type: str
    default: Value | None
    span: Span
    low: float | None = None
    high: float | None = None
    choices: tuple[Value, ...] = ()
    length: int | None = None
    unit: str | None = None
    doc: str = ""

    @property
    def is_angle(self) -> bool:
        return self.unit in ("deg", "rad")

    def read(self, value: Value) -> Value | Diagnostic:
        """Return the value as it is stored, or the error about it.

        An angle with a unit becomes a number in the parameter's unit.
        """
        if self.is_angle and isinstance(value, str) and (angle := Angle.read(value)):
            value = angle.in_unit(str(self.unit))
        if not _has_type(value, self.type):
            help = "declare it as `{type: float, …}` to have any number" if self.type == "int" else None
            return Diagnostic(
                "wrong-type",
                f"parameter `{self.name}` is {_NOUNS[self.type]}, got {_quoted(value)}",
                help=help,
            )
        if self.choices and value not in self.choices:
            known = [self._shown(each) for each in self.choices]
            listed = ", ".join(f"`{each}`" for each in known)
            help = did_you_mean(self._shown(value), known)
            return Diagnostic(
                "out-of-range", f"parameter `{self.name}` is one of {listed}, got {_quoted(value)}", help=help
            )
        if isinstance(value, tuple) and self.length is not None and len(value) != self.length:
            return Diagnostic(
                "wrong-length", f"parameter `{self.name}` has {self.length} numbers, got {len(value)}"
            )
        for number in value if isinstance(value, tuple) else (value,):
            if isinstance(number, bool) or not isinstance(number, (int, float)):
                continue
            if self.low is not None and number < self.low:
                return Diagnostic(
                    "out-of-range",
                    f"parameter `{self.name}` is at least {self._shown(self.low)}, got {self._shown(number)}",
                )
            if self.high is not None and number > self.high:
                return Diagnostic(
                    "out-of-range",
                    f"parameter `{self.name}` is at most {self._shown(self.high)}, got {self._shown(number)}",
                )
        return value

    def _shown(self, value: Value) -> str:
        return shown(value) + (str(self.unit) if self.is_angle and isinstance(value, int | float) else "")


_NOUNS = {
    "bool": "`true` or `false`",
    "int": "a whole number",
    "float": "a number",
    "string": "text",
    "vector": "a list of numbers",
}


def _has_type(value: Value, type: str) -> bool:
    if type == "bool" or isinstance(value, bool):
        return type == "bool" and isinstance(value, bool)
    if type == "int":
        return isinstance(value, int)
    if type == "float":
        return isinstance(value, (int, float))
    if type == "string":
        return isinstance(value, str)
    return isinstance(value, tuple) and all(_has_type(each, "float") for each in value)


def _quoted(value: Value) -> str:
    text = shown(value)
    return f"{kind(value)} `{text}`" if len(text) <= 40 else kind(value)


def inferred(default: Value) -> tuple[str, Value, str | None]:
    """Return type, value and unit of a parameter of which only the default is known.

    >>> inferred(1), inferred("90deg"), inferred("left")
    (('float', 1, None), ('float', 90.0, 'deg'), ('string', 'left', None))
    """
    if isinstance(default, bool):
        return "bool", default, None
    if isinstance(default, (int, float)):
        return "float", default, None
    if isinstance(default, tuple):
        return "vector", default, None
    angle = Angle.read(default)
    return ("float", angle.value, angle.unit) if angle else ("string", default, None)
