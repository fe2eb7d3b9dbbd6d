"""Evaluate expressions and texts with `${…}` in limited time.

A value is a boolean, a text, a vector, a table, a plain number or an angle. An angle stays one through every operation
that has a meaning for angles, and a plain number next to it is an error, unless it is 0, which is the same in every
unit.
"""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import lru_cache
from typing import Any, get_args

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Span
from mjcompose.base.limits import advice, in_force
from mjcompose.base.suggest import did_you_mean
from mjcompose.text import expression as syntax
from mjcompose.text.expression import (
    Angle,
    DataTable,
    Expression,
    ExpressionError,
    Number,
    Rewrite,
    Value,
    Variable,
    WrongUnits,
    kind,
    leaves,
    parse,
    shown,
)
from mjcompose.text.node import OPENING

_MAX_EXPONENT = 1024
_SHOWN_ROWS = 12
_ARITHMETIC: Mapping[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": operator.pow,
}
_OF_ANGLES = ("+", "-", "//", "%")  # both operands are angles, or none is; `//` counts how often one is in the other
_FIELDS = {kind: tuple(each.name for each in fields(kind)) for kind in get_args(Expression)}
_ORDER: Mapping[str, Callable[[Any, Any], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def evaluate(tree: Expression, scope: Mapping[str, Value]) -> Value:
    """Return the value with the names of `scope`. Raises `ExpressionError`."""
    if isinstance(tree, syntax.Constant):
        return tree.value
    if isinstance(tree, Variable):
        found = scope.get(tree.key)
        return _constant(tree, scope) if found is None else found
    if isinstance(tree, syntax.Subscript):
        return _item(tree, scope)
    if isinstance(tree, syntax.VectorLiteral):
        return tuple(evaluate(item, scope) for item in tree.items)
    if isinstance(tree, syntax.Unary):
        return _unary(tree, scope)
    if isinstance(tree, syntax.Comparison):
        return _comparison(tree, scope)
    if isinstance(tree, syntax.Conditional):
        return evaluate(tree.yes if _boolean(tree.condition, "if", scope) else tree.no, scope)
    return _call(tree, scope) if isinstance(tree, syntax.Call) else _binary(tree, scope)


def names(tree: Expression) -> Iterator[Variable]:
    """Yield every name in an expression, including constants such as `pi`."""
    if isinstance(tree, Variable):
        yield tree
    for child in _children(tree):
        yield from names(child)


def _children(tree: Expression) -> Iterator[Expression]:
    for name in _FIELDS[type(tree)]:
        value = getattr(tree, name)
        children = value if isinstance(value, tuple) else (value,)
        for child in children:
            if isinstance(child, Expression):
                yield child


def _constant(tree: Variable, scope: Mapping[str, Value]) -> Value:
    if tree.space == syntax.PARAMETERS and tree.name in scope:
        return scope[tree.name]
    if tree.space:
        raise syntax.UnknownName(tree.name, tree.at, tree.space)
    if tree.name in syntax.CONSTANTS:
        return syntax.CONSTANTS[tree.name]
    if tree.name.lower() in ("true", "false"):
        raise ExpressionError(f"`{tree.name}` does not exist", tree.at, f"write `{tree.name.lower()}`")
    if tree.name in syntax.FUNCTIONS:
        raise ExpressionError(f"`{tree.name}` is a function", tree.at, f"write `{tree.name}(…)`")
    raise syntax.UnknownName(tree.name, tree.at)


def _item(tree: syntax.Subscript, scope: Mapping[str, Value]) -> Value:
    whole = evaluate(tree.of, scope)
    index = evaluate(tree.index, scope)
    if isinstance(whole, DataTable):
        return _row(tree, whole, index)
    if isinstance(index, str):
        help = "its items have numbers: the first one is `[0]`" if isinstance(whole, tuple) else None
        raise ExpressionError(f"{kind(whole)} has no row `{index}`", tree.index.at, help)
    if not isinstance(whole, tuple):
        raise ExpressionError(f"{kind(whole)} has no items", tree.at)
    if isinstance(index, bool) or not isinstance(index, int):
        got = f"`{shown(index)}`" if isinstance(index, float) else kind(index)
        raise ExpressionError(f"an index is a whole number, got {got}", tree.index.at)
    if not -len(whole) <= index < len(whole):
        raise ExpressionError(f"item {index} does not exist: the vector has {len(whole)}", tree.at)
    return whole[index]


def _row(tree: syntax.Subscript, table: DataTable, name: Value) -> Value:
    if not isinstance(name, str):
        raise ExpressionError(f"the rows of a table have names, got {kind(name)}", tree.index.at)
    if name not in table:
        raise _missing(tree, name, table)
    return table[name]


def _missing(tree: syntax.Subscript, name: str, table: DataTable) -> ExpressionError:
    whole, item = ("the row", "column") if isinstance(tree.of, syntax.Subscript) else ("the table", "row")
    names = [f"`{each}`" for each in itertools.islice(table, _SHOWN_ROWS)]
    more = ", …" if len(table) > _SHOWN_ROWS else ""
    listed = f"its {item}s are {', '.join(names)}{more}" if names else "it is empty"
    message = f"{whole} has no {item} `{name}`; {listed}"
    return ExpressionError(message, tree.index.at, did_you_mean(name, table))


def place_of(tree: Expression, scope: Mapping[str, Value]) -> Span | None:
    """Return where the table has the value of an expression, or None for any other value."""
    if not isinstance(tree, syntax.Subscript):
        return None
    whole = evaluate(tree.of, scope)
    if isinstance(whole, DataTable):
        place = whole.places.get(str(evaluate(tree.index, scope)))
        return None if place is None else place.value
    return place_of(tree.of, scope)


def _number(tree: Expression, what: str, scope: Mapping[str, Value]) -> Number | Angle:
    return _as_number(evaluate(tree, scope), tree, what)


def _as_number(value: Value, tree: Expression, what: str) -> Number | Angle:
    if isinstance(value, bool) or not isinstance(value, (int, float, Angle)):
        raise ExpressionError(f"{what} needs a number, got {kind(value)}", tree.at)
    return value


def _boolean(tree: Expression, what: str, scope: Mapping[str, Value]) -> bool:
    value = evaluate(tree, scope)
    if not isinstance(value, bool):
        raise ExpressionError(f"`{what}` needs a boolean, got {kind(value)}", tree.at)
    return value


def _unary(tree: syntax.Unary, scope: Mapping[str, Value]) -> Value:
    if tree.operator == "not":
        return not _boolean(tree.operand, "not", scope)
    value = _number(tree.operand, f"`{tree.operator}`", scope)
    if tree.operator == "+":
        return value
    return Angle(-value.value, value.unit) if isinstance(value, Angle) else -value


def _binary(tree: syntax.Binary, scope: Mapping[str, Value]) -> Value:
    if tree.operator in ("and", "or"):
        left = _boolean(tree.left, tree.operator, scope)
        return left if left == (tree.operator == "or") else _boolean(tree.right, tree.operator, scope)
    # Evaluate each operand once: sums nest on the left, and twice each would be exponential in the number of terms.
    first = evaluate(tree.left, scope)
    if tree.operator == "+" and isinstance(first, str):
        second = evaluate(tree.right, scope)
        most = in_force().string
        if not isinstance(second, str):
            raise ExpressionError(f"`+` of text and {kind(second)}", tree.at)
        if len(first) + len(second) > most:
            raise ExpressionError(f"text is at most {most} characters long", tree.at, advice("string"))
        return first + second
    what = f"`{tree.operator}`"
    a = _as_number(first, tree.left, what)
    b = _number(tree.right, what, scope)
    if isinstance(a, Angle) or isinstance(b, Angle):
        return _of_angles(tree, a, b)
    return _arithmetic(tree, a, b)


def _arithmetic(tree: syntax.Binary, a: Number, b: Number) -> Number:
    if tree.operator == "**" and abs(b) > _MAX_EXPONENT:
        raise ExpressionError(f"an exponent is at most {_MAX_EXPONENT}, got {shown(b)}", tree.right.at)
    return _checked(tree, lambda: _ARITHMETIC[tree.operator](a, b), (a, b))


def _of_angles(tree: syntax.Binary, a: Number | Angle, b: Number | Angle) -> Number | Angle:
    """Return the result of arithmetic with at least one angle."""
    symbol = tree.operator
    if symbol in _OF_ANGLES or (symbol == "/" and isinstance(a, Angle) and isinstance(b, Angle)):
        (first, second), unit = _in_one_unit(f"`{symbol}`", [(tree.left, a), (tree.right, b)], tree)
        number = _arithmetic(tree, first, second)
        return number if symbol in ("/", "//") else Angle(number, unit)
    if isinstance(a, Angle) and not isinstance(b, Angle) and symbol in ("*", "/"):
        return Angle(_arithmetic(tree, a.value, b), a.unit)
    if isinstance(b, Angle) and not isinstance(a, Angle) and symbol == "*":
        return Angle(_arithmetic(tree, a, b.value), b.unit)
    raise WrongUnits(
        f"`{symbol}` of {kind(a)} and {kind(b)}", tree.at, _plain(tree.right if symbol == "/" else tree.left)
    )


_Operand = tuple[Expression, Number | Angle]


def _in_one_unit(what: str, operands: Sequence[_Operand], tree: Expression) -> tuple[list[Number], syntax.Unit]:
    """Return the numbers of angles in the unit of the first of them, and that unit. Only a 0 needs no unit."""
    unit = next(value.unit for _, value in operands if isinstance(value, Angle))
    for side, value in operands:
        if not isinstance(value, Angle) and value != 0:
            raise WrongUnits(f"{what} of an angle and a number without a unit", tree.at, _with_units(side, operands))
    return [value.in_unit(unit) if isinstance(value, Angle) else value for _, value in operands], unit


def _with_units(side: Expression, operands: Sequence[_Operand]) -> list[Rewrite]:
    """Return the two meanings of a plain number next to an angle."""
    if isinstance(side.value if isinstance(side, syntax.Constant) else None, int | float):
        return [Rewrite(side.at, "", unit) for unit in syntax.UNITS]
    if isinstance(side, syntax.Unary):
        return _with_units(side.operand, operands)
    angles = [each for each, value in operands if isinstance(value, Angle)]
    return _plain(angles[0]) if len(angles) == 1 else []


def _plain(angle: Expression) -> list[Rewrite]:
    """Return the two plain numbers that an angle can mean."""
    return [Rewrite(angle.at, f"{unit}(", ")") for unit in syntax.UNITS]


def _comparison(tree: syntax.Comparison, scope: Mapping[str, Value]) -> bool:
    values = [evaluate(operand, scope) for operand in tree.operands]
    for at, (symbol, left, right) in enumerate(zip(tree.operators, values, values[1:], strict=False)):
        if isinstance(left, Angle) or isinstance(right, Angle):
            left = _difference(symbol, [(tree.operands[at], left), (tree.operands[at + 1], right)])
            right = 0
        if kind(left) != kind(right):
            raise ExpressionError(f"`{symbol}` of {kind(left)} and {kind(right)}", tree.at)
        if symbol not in ("==", "!=") and kind(left) not in ("a number", "text"):
            raise ExpressionError(f"`{symbol}` needs numbers or text, got {kind(left)}", tree.at)
        if not _ORDER[symbol](left, right):
            return False
    return True


def _difference(symbol: str, sides: Sequence[tuple[Expression, Value]]) -> float:
    """Return how far the first angle is above the second."""
    at = sides[0][0].at[0], sides[1][0].at[1]
    for _, value in sides:
        if isinstance(value, bool) or not isinstance(value, int | float | Angle):
            raise ExpressionError(f"`{symbol}` of {' and '.join(kind(each) for _, each in sides)}", at)
    operands = [(tree, value) for tree, value in sides if isinstance(value, int | float | Angle)]
    (first, second), unit = _in_one_unit(f"`{symbol}`", operands, syntax.VectorLiteral((), at))
    return Angle(first, unit).compared_to(Angle(second, unit))


def _call(tree: syntax.Call, scope: Mapping[str, Value]) -> Value:
    function = syntax.FUNCTIONS[tree.function]
    count = len(tree.arguments)
    if count < function.least or (function.most is not None and count > function.most):
        takes = f"at least {function.least}" if function.most is None else f"{function.least} or {function.most}"
        takes = str(function.least) if function.least == function.most else takes
        raise ExpressionError(f"`{tree.function}` takes {takes} numbers, got {count}", tree.at)
    arguments = [_number(argument, f"`{tree.function}`", scope) for argument in tree.arguments]
    if function.angles == syntax.GIVES or any(isinstance(argument, Angle) for argument in arguments):
        return _call_of_angles(tree, function, arguments)
    plain = [argument for argument in arguments if not isinstance(argument, Angle)]
    return _checked(tree, lambda: function.apply(*plain), plain)


def _call_of_angles(tree: syntax.Call, function: syntax.Function, arguments: list[Number | Angle]) -> Number | Angle:
    """Return the result of a function that takes or gives angles."""
    operands = list(zip(tree.arguments, arguments, strict=True))
    angles = [(argument, value) for argument, value in operands if isinstance(value, Angle)]
    if not angles:
        plain = [value for value in arguments if not isinstance(value, Angle)]
        return Angle(_checked(tree, lambda: function.apply(*plain), plain), "rad")
    argument, angle = angles[0]
    if tree.function in syntax.UNITS:
        return angle.in_unit(tree.function)
    if function.angles == syntax.TAKES:
        return _checked(tree, lambda: function.apply(angle.radians), [angle.radians])
    if function.angles == syntax.PLAIN or (function.angles == syntax.GIVES and len(operands) == 1):
        raise WrongUnits(f"`{tree.function}` of an angle", tree.at, _plain(argument))
    numbers, unit = _in_one_unit(f"`{tree.function}`", operands, tree)
    number = _checked(tree, lambda: function.apply(*numbers), numbers)
    return Angle(number, "rad" if function.angles == syntax.GIVES else unit)


def _checked(tree: syntax.Binary | syntax.Call, work: Callable[[], Number], of: Sequence[Number]) -> Number:
    """Return a finite number that is not too large; `of` are the operands. Raises `ExpressionError`."""
    try:
        value = work()
    except ZeroDivisionError:
        raise ExpressionError("division by zero", tree.at) from None
    except OverflowError:
        raise ExpressionError("the result is too large", tree.at) from None
    except (ValueError, TypeError) as error:
        name = tree.function if isinstance(tree, syntax.Call) else tree.operator
        numbers = ", ".join(map(shown, of))
        reason = str(error) if isinstance(error, syntax.ArgumentError) else f"it is not defined at {numbers}"
        raise ExpressionError(f"`{name}`: {reason}", tree.at) from None
    if isinstance(value, complex):
        raise ExpressionError(f"the root of a negative number, {shown(of[0])} to the power of {shown(of[1])}", tree.at)
    if isinstance(value, int):
        if abs(value) >= syntax.MAX_INTEGER:
            raise ExpressionError("the result is too large for a whole number", tree.at)
    elif not math.isfinite(value):
        raise ExpressionError("the result is not a finite number", tree.at)
    return value


class Inserted(Struct):
    """An expression in a text: its tree, and the place and the text between its braces."""

    start: int
    text: str
    tree: Expression

    def value(self, scope: Mapping[str, Value]) -> Value:
        try:
            return evaluate(self.tree, scope)
        except WrongUnits as error:
            raise error.helped(self.text).moved(self.start) from None
        except ExpressionError as error:
            raise error.moved(self.start) from None


class Template(Struct):
    """Pieces of text, and expressions."""

    pieces: tuple[str | Inserted, ...]

    @classmethod
    @lru_cache(maxsize=64)  # a condition is evaluated for each element
    def parse(cls, text: str) -> Template:
        """Parse a text. Raises `ExpressionError` with positions in the whole text.

        >>> Template.parse("pad_${side}_${n + 1}").value({"side": "left", "n": 2})
        'pad_left_3'
        >>> Template.parse("${2 * reach}").value({"reach": 0.25})
        0.5
        """
        # Most expressions give at least one character, and counting the characters of too many would take minutes.
        count = text.count(OPENING)
        most = in_force().string
        if count > most:
            at = text.index(OPENING)
            message = f"the text has {count} expressions; {most} are allowed"
            raise ExpressionError(message, (at, at + len(OPENING)), advice("string", count))
        pieces: list[str | Inserted] = []
        at = 0
        while (start := text.find(OPENING, at)) >= 0:
            end = _closing(text, start)
            if start > at:
                pieces.append(text[at:start])
            inside = start + len(OPENING)
            try:
                pieces.append(Inserted(inside, text[inside:end], parse(text[inside:end])))
            except ExpressionError as error:
                raise error.moved(inside) from None
            at = end + 1
        if at < len(text):
            pieces.append(text[at:])
        return cls(tuple(pieces))

    def value(self, scope: Mapping[str, Value]) -> Value:
        """Evaluate the text with these names: a single expression gives a value of any type, other texts a text.

        In a text, an angle is its number in its own unit. Raises `ExpressionError`.

        >>> scope = {"t": Angle(10, "deg"), "v": (Angle(1, "rad"), Angle(2, "rad"))}
        >>> [Template.parse(text).value(scope) for text in ("${-t}", "${v[1]}", "${2 * t}", "${t}deg")]
        [Angle(value=-10, unit='deg'), Angle(value=2, unit='rad'), Angle(value=20, unit='deg'), '10deg']
        """
        values = [piece if isinstance(piece, str) else piece.value(scope) for piece in self.pieces]
        if len(values) == 1:
            return values[0]
        for piece, value in zip(self.pieces, values, strict=True):
            if isinstance(value, DataTable) and not isinstance(piece, str):
                raise _no_table(piece.tree, value).moved(piece.start)
        texts = [shown(value) for value in values]
        count = sum(len(text) for text, piece in zip(texts, self.pieces, strict=True) if text is not piece)
        most = in_force().string
        if count > most:
            at = next(piece.start for piece in self.pieces if not isinstance(piece, str))
            message = f"expressions give {count} characters; {most} are allowed"
            raise ExpressionError(message, (at, at + 1), advice("string", count))
        for piece, value, after in zip(self.pieces, values, texts[1:], strict=False):
            if isinstance(value, Angle) and not isinstance(piece, str):
                _check_unit_behind(piece, value, after)
        return "".join(texts)

    def markup(self, scope: Mapping[str, Value]) -> Value:
        """Evaluate a fragment of MJCF, whose numbers have no units: an angle in it is an error."""
        for piece in self.pieces:
            if not isinstance(piece, str) and any(isinstance(each, Angle) for each in leaves(piece.value(scope))):
                error = WrongUnits(
                    "an angle in a fragment of MJCF would lose its unit", piece.tree.at, _plain(piece.tree)
                )
                raise error.helped(piece.text).moved(piece.start)
        return self.value(scope)

    def place(self, scope: Mapping[str, Value]) -> Span | None:
        """Return where a table has the value, if the text is one expression that reads it, such as `${gains.hip.kp}`.

        The text must have a value with these names.
        """
        piece = self.pieces[0]
        return None if isinstance(piece, str) or not self.is_read else place_of(piece.tree, scope)

    @property
    def is_read(self) -> bool:
        """Return whether the text is one item or row of something."""
        piece = self.pieces[0]
        return len(self.pieces) == 1 and not isinstance(piece, str) and isinstance(piece.tree, syntax.Subscript)

    def names(self) -> Iterator[Variable]:
        for piece in self.pieces:
            if not isinstance(piece, str):
                for each in names(piece.tree):
                    yield Variable(each.name, (each.at[0] + piece.start, each.at[1] + piece.start), each.space)

    def parameters(self) -> Iterator[Variable]:
        """Yield the names that may be parameters or variants, which attributes of an element are not."""
        return (each for each in self.names() if each.space != syntax.ELEMENT)


def bound(text: str, turn: Mapping[str, Value], scope: Mapping[str, Value]) -> str:
    """Return a text in which the expressions have the values of the names in `turn`; other names stay.

    Items that only need names of the turn and of `scope` become values, too. Raises `ExpressionError`.

    >>> bound("${value * k[i] + name}", {"i": 1}, {"k": (2, -3)})
    '${value * (-3) + name}'
    """
    for piece in reversed(Template.parse(text).pieces):
        if isinstance(piece, str):
            continue
        try:
            literals = list(_literals(piece.tree, turn, {**scope, **turn}))
        except ExpressionError as error:
            raise error.moved(piece.start) from None
        for (first, last), literal in reversed(literals):
            text = f"{text[: piece.start + first]}{literal}{text[piece.start + last :]}"
    return text


def _literals(
    tree: Expression, turn: Mapping[str, Value], scope: Mapping[str, Value]
) -> Iterator[tuple[syntax.Range, str]]:
    """Yield the parts of an expression that a turn determines, from left to right, with their values as text."""
    if isinstance(tree, Variable):
        if tree.key in turn:
            yield tree.at, _literal(turn[tree.key], tree)
        return
    if isinstance(tree, syntax.Subscript) and _is_read(tree):
        used = {each.key for each in names(tree)}
        if not used.isdisjoint(turn) and used <= scope.keys():
            yield tree.at, _literal(evaluate(tree, scope), tree)
            return
    for child in sorted(_children(tree), key=lambda child: child.at):
        yield from _literals(child, turn, scope)


def _is_read(tree: Expression) -> bool:
    """Return whether an expression begins with a name, whose items it takes; its place covers all its text."""
    while isinstance(tree, syntax.Subscript):
        tree = tree.of
    return isinstance(tree, Variable) and not tree.space


def _no_table(tree: Expression, table: DataTable) -> ExpressionError:
    whole, item = ("a row", "column") if isinstance(tree, syntax.Subscript) else ("a table", "row")
    first = next(iter(table), "NAME")
    example = f".{first}" if first.isidentifier() else f'["{first}"]'
    return ExpressionError(f"{whole} has no value here", tree.at, f"write which {item} of it, such as `{example}`")


def _literal(value: Value, tree: Expression) -> str:
    """Return a value as an expression writes it. Raises `ExpressionError`."""
    if isinstance(value, DataTable):
        raise _no_table(tree, value)
    if isinstance(value, tuple):
        return f"[{', '.join(_literal(each, tree) for each in value)}]"
    if isinstance(value, str):
        quote = '"' if "'" in value else "'"
        if quote in value:
            raise ExpressionError("a text with both kinds of quotes cannot be used here", tree.at)
        return f"{quote}{value}{quote}"
    text = syntax.with_units(value)
    return f"({text})" if text.startswith("-") else text


@lru_cache(maxsize=64)
def keys_in(text: str) -> frozenset[str]:
    """Return the names in the expressions of a text, with their space. Raises `ExpressionError`."""
    return frozenset(each.key for each in Template.parse(text).names())


def _check_unit_behind(piece: Inserted, angle: Angle, after: str) -> None:
    """Report `${…}deg` of an angle in radians: its number in radians would become one in degrees."""
    unit = after[:3]
    if unit in syntax.UNITS and unit != angle.unit and not after[3:4].isalnum():
        at = piece.start, piece.start + len(piece.text)
        help = f"leave `{unit}` and any conversion out: an angle keeps its unit"
        raise ExpressionError(f"an angle in {angle.unit} is followed by `{unit}`", at, help)


def _closing(text: str, start: int) -> int:
    """Return the position of the brace that closes the brace at `start`, ignoring braces in quotes."""
    quote = ""
    for at in range(start + len(OPENING), len(text)):
        character = text[at]
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character == "}":
            return at
    raise ExpressionError("`${` is never closed", (start, len(text)), "put `}` after the expression")
