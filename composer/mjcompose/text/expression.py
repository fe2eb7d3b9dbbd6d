"""Parse the text of an expression into a tree; the values and types of expressions."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from string import ascii_letters, digits
from typing import Any, Literal, NamedTuple, TypeAlias

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span

Unit = Literal["deg", "rad"]
UNITS: Mapping[str, Unit] = {"deg": "deg", "rad": "rad"}
ANGLE_PATTERN = r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?(?:deg|rad)"
_ANGLE = re.compile(ANGLE_PATTERN)
_ROUNDING = 1e-12


class Angle(Struct):
    """A number with its unit: `90deg`, `1.57rad`."""

    value: float
    unit: Unit

    @property
    def radians(self) -> float:
        return self.in_unit("rad")

    @classmethod
    def read(cls, text: str) -> Angle | None:
        """Return the angle in a text, or None if it is not an angle.

        >>> Angle.read("-90deg"), Angle.read("90"), Angle.read("deg")
        (Angle(value=-90.0, unit='deg'), None, None)
        """
        if text[-3:] not in UNITS or _ANGLE.fullmatch(text) is None:
            return None
        value = float(text[:-3])
        return cls(value, UNITS[text[-3:]]) if math.isfinite(value) else None

    def in_unit(self, unit: str) -> float:
        """Return the number in another unit, `deg` or `rad`."""
        if unit == self.unit:
            return self.value
        return math.radians(self.value) if unit == "rad" else math.degrees(self.value)

    def compared_to(self, other: Angle) -> float:
        """Return how far the angle is above another one, in radians: 0 if only the change of the unit rounds.

        >>> Angle(30, "deg").compared_to(Angle(math.pi / 6, "rad")), Angle(1, "rad").compared_to(Angle(1, "deg")) > 0
        (0.0, True)
        """
        difference = self.radians - other.radians
        return 0.0 if abs(difference) <= _ROUNDING * max(1.0, abs(self.radians)) else difference

    def __str__(self) -> str:
        return f"{self.value:.17g}{self.unit}"


class RowPlace(NamedTuple):
    """Where the name of a row, and its value, are written."""

    name: Span
    value: Span


class DataTable(dict[str, "Value"]):
    """The rows of a table by name, or the values of a row by column, with their `places` for messages."""

    __slots__ = ("places",)

    def __init__(self, rows: Mapping[str, Value], places: Mapping[str, RowPlace] | None = None) -> None:
        super().__init__(rows)
        self.places = places or {}


Value = bool | int | float | str | Angle | tuple["Value", ...] | DataTable

MAX_INTEGER = 2**63


def leaves(value: Value) -> Iterator[Value]:
    """Yield the single values in a value.

    >>> list(leaves((1, DataTable({"a": 2, "b": (3, "x")}))))
    [1, 2, 3, 'x']
    """
    if isinstance(value, tuple | DataTable):
        items = value.values() if isinstance(value, DataTable) else value
        for each in items:
            yield from leaves(each)
    else:
        yield value


def with_leaves(value: Value, change: Callable[[Value], Value]) -> Value:
    """Return the value with each single value in it changed.

    >>> with_leaves((1, DataTable({"a": 2})), lambda each: each + 1)
    (2, {'a': 3})
    """
    if isinstance(value, tuple):
        return tuple(with_leaves(each, change) for each in value)
    if isinstance(value, DataTable):
        return DataTable({name: with_leaves(each, change) for name, each in value.items()}, value.places)
    return change(value)


def number_of(value: Value) -> Value:
    """Return the number of an angle, in its own unit, as texts and manifests show it. Other values stay."""
    return with_leaves(value, lambda each: each.value if isinstance(each, Angle) else each)


def written(value: Value) -> bool | int | float | str | list[Any] | dict[str, Any]:
    """Return a value as a recipe writes it: an angle as `10deg`, a vector as a list, a table as a mapping.

    >>> written((Angle(10, "deg"), 0.5))
    ['10deg', 0.5]
    """
    if isinstance(value, tuple):
        return [written(each) for each in value]
    if isinstance(value, DataTable):
        return {name: written(each) for name, each in value.items()}
    return with_units(value) if isinstance(value, Angle) else value


def with_units(value: Value) -> str:
    """Return a value as text, with the unit of an angle.

    >>> with_units((Angle(10, "deg"), 0.5))
    '[10deg, 0.5]'
    """
    return _text_of(value, lambda angle: f"{shown(angle)}{angle.unit}")


def _text_of(value: Value, of_angle: Callable[[Angle], str]) -> str:
    if isinstance(value, tuple):
        return f"[{', '.join(_text_of(each, of_angle) for each in value)}]"
    if isinstance(value, DataTable):
        return f"{{{', '.join(f'{name}: {_text_of(each, of_angle)}' for name, each in value.items())}}}"
    if isinstance(value, Angle):
        return of_angle(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    return value if isinstance(value, str) else repr(value)


def kind(value: Value) -> str:
    """Return the noun in messages for a value's type.

    >>> kind(True), kind(2), kind(2.0), kind("x"), kind((1, 2)), kind(Angle(2, "deg")), kind(DataTable({}))
    ('a boolean', 'a number', 'a number', 'text', 'a vector', 'an angle', 'a table')
    """
    if isinstance(value, bool):
        return "a boolean"
    if isinstance(value, (int, float)):
        return "a number"
    if isinstance(value, Angle):
        return "an angle"
    if isinstance(value, DataTable):
        return "a table"
    return "text" if isinstance(value, str) else "a vector"


def shown(value: Value) -> str:
    """Return a value as text: the shortest text that reads back as the same number.

    >>> shown(0.1), shown(2.0), shown(2), shown(True), shown((1, 0.5)), shown("left"), shown(DataTable({"a": 1}))
    ('0.1', '2.0', '2', 'true', '[1, 0.5]', 'left', '{a: 1}')
    """
    return _text_of(value, lambda angle: repr(angle.value))


Number = int | float


class ArgumentError(ValueError):
    """An argument that a function does not accept; the text says why."""


# How a function treats angles. Each of its arguments is an angle, or none is.
KEEPS: Literal["keeps"] = "keeps"  # `min`: it gives an angle for angles, and a number for numbers
TAKES: Literal["takes"] = "takes"  # `sin`: it takes an angle, or a number of radians, and gives a number
GIVES: Literal["gives"] = "gives"  # `atan2`: it takes numbers, or angles whose ratio counts, and gives an angle
PLAIN: Literal["plain"] = "plain"  # `sqrt`: it has no meaning for an angle


class Function(NamedTuple):
    """A function of expressions; `apply` takes `least` to `most` numbers (None: any number)."""

    apply: Callable[..., Number]
    least: int = 1
    most: int | None = 1
    angles: Literal["keeps", "takes", "gives", "plain"] = PLAIN


def _round(value: Number, digits: Number = 0) -> Number:
    if isinstance(digits, float) or not -20 <= digits <= 20:
        raise ArgumentError("the second argument is the number of digits, a whole number up to 20")
    return round(value, digits) if digits else round(value)


def _clamp(value: Number, low: Number, high: Number) -> Number:
    if low > high:
        raise ArgumentError(f"the lower bound {low} is above the upper bound {high}")
    return min(max(value, low), high)


CONSTANTS: Mapping[str, Value] = {"pi": math.pi}
FUNCTIONS: Mapping[str, Function] = {
    "abs": Function(abs, angles=KEEPS), "min": Function(min, 2, None, KEEPS), "max": Function(max, 2, None, KEEPS),
    "round": Function(_round, 1, 2), "floor": Function(math.floor), "ceil": Function(math.ceil),
    "sqrt": Function(math.sqrt), "exp": Function(math.exp), "log": Function(math.log, 1, 2),
    "sin": Function(math.sin, angles=TAKES), "cos": Function(math.cos, angles=TAKES),
    "tan": Function(math.tan, angles=TAKES), "asin": Function(math.asin, angles=GIVES),
    "acos": Function(math.acos, angles=GIVES), "atan": Function(math.atan, angles=GIVES),
    "atan2": Function(math.atan2, 2, 2, GIVES), "hypot": Function(math.hypot, 2, None, KEEPS),
    "clamp": Function(_clamp, 3, 3, KEEPS),
    # For an angle, its number in that unit; a number is one in the other unit.
    "deg": Function(math.degrees, angles=TAKES), "rad": Function(math.radians, angles=TAKES),
}  # fmt: skip

Range: TypeAlias = tuple[int, int]  # the first character of something in the parsed text, and the one after its last


class ExpressionError(Exception):
    """An error at some characters of the parsed text; `help` says how to fix it."""

    def __init__(self, message: str, at: Range, help: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.at = at
        self.help = help

    def moved(self, by: int) -> ExpressionError:
        self.at = self.at[0] + by, self.at[1] + by
        return self


class UnknownName(ExpressionError):
    """A name that the scope does not have; code that knows the existing names can give more details."""

    def __init__(self, name: str, at: Range, space: str = "") -> None:
        super().__init__(f"`{space}.{name}` does not exist" if space else f"`{name}` does not exist", at)
        self.name = name
        self.space = space


class Rewrite(NamedTuple):
    """Texts to put around some characters of an expression."""

    at: Range
    before: str
    after: str

    def of(self, text: str) -> str:
        start, end = self.at
        return f"{text[:start]}{self.before}{text[start:end]}{self.after}{text[end:]}"


class WrongUnits(ExpressionError):
    """An angle where only a number has a meaning, or the other way round; each of `rewrites` is a way out."""

    def __init__(self, message: str, at: Range, rewrites: Sequence[Rewrite] = ()) -> None:
        super().__init__(message, at)
        self.rewrites = rewrites

    def helped(self, text: str) -> WrongUnits:
        """Add the help, which quotes the `text` of the whole expression."""
        if self.rewrites and len(text) <= _LONGEST_QUOTED:
            self.help = f"write {' or '.join(f'`{each.of(text)}`' for each in self.rewrites)}"
        return self


_LONGEST_QUOTED = 100


class Constant(Struct):
    value: Value
    at: Range


PARAMETERS = "params"
ELEMENT = "element"


class Variable(Struct):
    """A name: `reach`, or with the `space` that it is from, `params.reach` and `element.damping`."""

    name: str
    at: Range
    space: str = ""

    @property
    def key(self) -> str:
        return f"{self.space}.{self.name}" if self.space else self.name


class Subscript(Struct):
    """An item of a vector or a row of a table: `of[index]`, and `of.row` for `of["row"]`."""

    of: Expression
    index: Expression
    at: Range


class VectorLiteral(Struct):
    items: tuple[Expression, ...]
    at: Range


class Unary(Struct):
    operator: str
    operand: Expression
    at: Range


class Binary(Struct):
    """Arithmetic, `and` and `or`."""

    operator: str
    left: Expression
    right: Expression
    at: Range


class Comparison(Struct):
    """A comparison such as `a < b <= c`: it has one operand more than operators."""

    operators: tuple[str, ...]
    operands: tuple[Expression, ...]
    at: Range


class Conditional(Struct):
    """A conditional expression: `yes if condition else no`."""

    condition: Expression
    yes: Expression
    no: Expression
    at: Range


class Call(Struct):
    function: str
    arguments: tuple[Expression, ...]
    at: Range


Expression = Constant | Variable | Subscript | VectorLiteral | Unary | Binary | Comparison | Conditional | Call


class ExpressionToken(NamedTuple):
    """A token of an expression: `kind` is `number`, `text`, `name`, `end`, or the operator or keyword itself."""

    kind: str
    text: str
    start: int

    @property
    def at(self) -> Range:
        return self.start, self.start + len(self.text)


KEYWORDS = frozenset({"and", "or", "not", "if", "else", "true", "false"})
_TOKEN = re.compile(
    r"""\s*(?:
        (?P<angle>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?(?:deg|rad)(?![\w.]))
      | (?P<number>(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<name>(?:(?:params|element)\.)?[^\W\d]\w*)
      | (?P<text>'[^']*'|"[^"]*")
      | (?P<operator>\*\*|//|<=|>=|==|!=|[-+*/%<>()\[\],.])
    )""",
    re.VERBOSE,
)
_MAX_TOKENS = 256
_MAX_DIGITS = 1000
_FOREIGN = {"&&": "and", "||": "or", "!": "not", "^": "**", "=": "=="}


def tokens(text: str) -> list[ExpressionToken]:
    """Return all tokens, the last one of kind `end`. Raises `ExpressionError`."""
    found: list[ExpressionToken] = []
    at = 0
    end = len(text.rstrip())
    while at < end:
        match = _TOKEN.match(text, at)
        if match is None:
            raise _unreadable(text, at + len(text[at:]) - len(text[at:].lstrip()))
        kind = str(match.lastgroup)
        token = match.group(kind)
        start = match.start(kind)
        if kind == "number" and match.end() < end and (text[match.end()].isalnum() or text[match.end()] in "_."):
            raise _run_on(text, start)
        if kind in ("number", "angle") and len(token) > _MAX_DIGITS:
            raise ExpressionError("the number is too long", (start, match.end()))
        found.append(ExpressionToken(token if kind == "operator" or token in KEYWORDS else kind, token, start))
        at = match.end()
        if len(found) > _MAX_TOKENS:
            raise ExpressionError("the expression is too long", (0, len(text)), "make parts of it parameters")
    found.append(ExpressionToken("end", "", end))
    return found


def _unreadable(text: str, at: int) -> ExpressionError:
    if text[at] in "'\"":
        return ExpressionError(f"the text that begins with {text[at]} has no end", (at, len(text)))
    for foreign, ours in _FOREIGN.items():
        if text.startswith(foreign, at):
            return ExpressionError(f"`{foreign}` is not an operator", (at, at + len(foreign)), f"write `{ours}`")
    return ExpressionError(f"`{text[at]}` has no meaning in an expression", (at, at + 1))


def _run_on(text: str, start: int) -> ExpressionError:
    word = re.split(r"[^\w.]", text[start:], maxsplit=1)[0]
    number = word.rstrip(ascii_letters + "°")
    unit = word.lstrip(digits + ".")
    near = {"°": "deg", "degrees": "deg", "degree": "deg", "radians": "rad", "radian": "rad"}.get(unit)
    help = f"write `{number}{near}`" if near else None
    return ExpressionError(f"`{word}` is not a number", (start, start + len(word)), help)


_MAX_DEPTH = 50
# From loose to tight, each level left to right; `**` binds tighter than a sign before it and goes right to left.
_LEVELS = (("or",), ("and",), ("not",), ("+", "-"), ("*", "/", "//", "%"))
_NEGATION = 2
_COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")


def parse(text: str) -> Expression:
    """Return the tree of an expression. Raises `ExpressionError`."""
    parser = _Parser(tokens(text))
    if parser.next.kind == "end":
        raise ExpressionError("the expression is empty", (0, len(text)), "write for instance `${2 * reach}`")
    tree = parser.choice()
    if parser.next.kind != "end":
        raise parser.unexpected("an operator")
    return tree


class _Parser:
    def __init__(self, found: list[ExpressionToken]) -> None:
        self.found = found
        self.at = 0
        self.depth = 0

    @property
    def next(self) -> ExpressionToken:
        return self.found[self.at]

    def take(self, *kinds: str) -> ExpressionToken | None:
        token = self.next
        if token.kind not in kinds:
            return None
        self.at += 1
        return token

    def expect(self, kind: str, opened: ExpressionToken) -> ExpressionToken:
        token = self.take(kind)
        if token is None:
            if self.next.kind == "end":
                raise ExpressionError(f"`{opened.text}` is never closed", opened.at)
            raise self.unexpected(f"`{kind}`")
        return token

    def unexpected(self, wanted: str) -> ExpressionError:
        token = self.next
        if token.kind == "end":
            return ExpressionError(f"the expression ends without {wanted}", (max(token.start - 1, 0), token.start))
        help = "compare with each: `a == 1 or a == 2`" if token.text in ("in", "not") else None
        if token.kind == "number" and token.text.startswith("."):
            help = f'a row with such a name is `["{token.text[1:]}"]`'
        return ExpressionError(f"expected {wanted}, got `{token.text}`", token.at, help)

    def descend(self) -> None:
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise ExpressionError("the expression is nested too deep", self.next.at)

    def choice(self) -> Expression:
        self.descend()
        value = self.level(0)
        if self.take("if"):
            condition = self.level(0)
            if self.take("else") is None:
                raise self.unexpected("`else`")
            other = self.choice()
            value = Conditional(condition, value, other, at=_over(value, other))
        self.depth -= 1
        return value

    def comparison(self) -> Expression:
        operands = [self.level(_NEGATION + 1)]
        operators: list[str] = []
        while token := self.take(*_COMPARISONS):
            operators.append(token.kind)
            operands.append(self.level(_NEGATION + 1))
        if not operators:
            return operands[0]
        return Comparison(tuple(operators), tuple(operands), at=_over(operands[0], operands[-1]))

    def level(self, number: int) -> Expression:
        if number == _NEGATION:
            return self.prefixed(self.comparison, "not")
        if number == len(_LEVELS):
            return self.prefixed(self.power, "-", "+")
        left = self.level(number + 1)
        while token := self.take(*_LEVELS[number]):
            right = self.level(number + 1)
            left = Binary(token.kind, left, right, at=_over(left, right))
        return left

    def prefixed(self, operand: Callable[[], Expression], *operators: str) -> Expression:
        signs = []
        while token := self.take(*operators):
            signs.append(token)
        value = operand()
        for token in reversed(signs):
            value = Unary(token.kind, value, _over(token, value))
        return value

    def power(self) -> Expression:
        base = self.item()
        if self.take("**") is None:
            return base
        self.descend()
        exponent = self.prefixed(self.power, "-", "+")
        self.depth -= 1
        return Binary("**", base, exponent, at=_over(base, exponent))

    def item(self) -> Expression:
        first = self.next
        value = self.atom()
        while opened := self.take("[", "."):
            if opened.kind == "[":
                index = self.choice()
                value = Subscript(value, index, at=_over(first, self.expect("]", opened)))
            elif row := self.take("name", *KEYWORDS):
                value = Subscript(value, Constant(row.text, row.at), at=_over(first, row))
            else:
                raise self.unexpected("the name of a row")
        return value

    def atom(self) -> Expression:
        if token := self.take("number"):
            return Constant(_number(token), token.at)
        if token := self.take("angle"):
            return Constant(Angle(_number(token, token.text[:-3]), UNITS[token.text[-3:]]), token.at)
        if token := self.take("text"):
            return Constant(token.text[1:-1], token.at)
        if token := self.take("true", "false"):
            return Constant(token.kind == "true", token.at)
        if token := self.take("name"):
            opened = self.take("(")
            return self.call(token, opened) if opened else _named(token)
        if opened := self.take("("):
            value = self.choice()
            self.expect(")", opened)
            return value
        if opened := self.take("["):
            items, end = self.items(opened, "]")
            return VectorLiteral(items, (opened.start, end))
        raise self.unexpected("a value")

    def call(self, name: ExpressionToken, opened: ExpressionToken) -> Expression:
        if name.text not in FUNCTIONS:
            message = f"the function `{name.text}` does not exist; the functions are {', '.join(FUNCTIONS)}"
            raise ExpressionError(message, name.at)
        arguments, end = self.items(opened, ")")
        return Call(name.text, arguments, (name.start, end))

    def items(self, opened: ExpressionToken, closing: str) -> tuple[tuple[Expression, ...], int]:
        found: list[Expression] = []
        while not (closed := self.take(closing)):
            if found:
                if self.take(",") is None:
                    return tuple(found), self.expect(closing, opened).at[1]
                if closed := self.take(closing):
                    break
            found.append(self.choice())
        return tuple(found), closed.at[1]


def _named(token: ExpressionToken) -> Variable:
    space, dot, name = token.text.rpartition(".")
    return Variable(name, (token.start + len(space + dot), token.at[1]), space)


def _number(token: ExpressionToken, text: str | None = None) -> int | float:
    text = token.text if text is None else text
    if text.isdigit():
        if len(text) > 19:
            raise ExpressionError("a number too large for an expression", token.at)
        return int(text)
    value = float(text)
    if value in (float("inf"), float("-inf")):
        raise ExpressionError(f"`{token.text}` is too large for a number", token.at)
    return value


def _over(first: Expression | ExpressionToken, last: Expression | ExpressionToken) -> Range:
    return first.at[0], last.at[1]
