"""Evaluate expressions and texts with `${…}` in limited time."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import fields
from functools import lru_cache

from mjcompose.base.dataclass import Struct
from mjcompose.base.limits import advice, in_force
from mjcompose.text import expression as syntax
from mjcompose.text.expression import Expression, ExpressionError, Name, Value, kind, parse, shown
from mjcompose.text.node import OPENING

_MAX_EXPONENT = 1024
_ARITHMETIC: Mapping[str, Callable[[float, float], float]] = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv, "//": operator.floordiv,
    "%": operator.mod, "**": operator.pow,
}  # fmt: skip
_ORDER: Mapping[str, Callable[[Value, Value], bool]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq, "!=": operator.ne,
}  # fmt: skip


def evaluate(tree: Expression, scope: Mapping[str, Value]) -> Value:
    """Return the value with the names of `scope`. Raises `ExpressionError`."""
    if isinstance(tree, syntax.Constant):
        return tree.value
    if isinstance(tree, Name):
        return scope[tree.name] if tree.name in scope else _constant(tree)
    if isinstance(tree, syntax.Item):
        return _item(tree, scope)
    if isinstance(tree, syntax.Vector):
        return tuple(evaluate(item, scope) for item in tree.items)
    if isinstance(tree, syntax.Unary):
        return _unary(tree, scope)
    if isinstance(tree, syntax.Comparison):
        return _comparison(tree, scope)
    if isinstance(tree, syntax.Choice):
        return evaluate(tree.yes if _boolean(tree.condition, "if", scope) else tree.no, scope)
    return _call(tree, scope) if isinstance(tree, syntax.Call) else _binary(tree, scope)


def names(tree: Expression) -> Iterator[Name]:
    """Yield every name in an expression, including constants such as `pi`."""
    if isinstance(tree, Name):
        yield tree
    for value in (getattr(tree, each.name) for each in fields(tree)):
        for child in value if isinstance(value, tuple) else (value,):
            if isinstance(child, Expression):
                yield from names(child)


def _constant(tree: Name) -> Value:
    if tree.name in syntax.CONSTANTS:
        return syntax.CONSTANTS[tree.name]
    if tree.name.lower() in ("true", "false"):
        raise ExpressionError(f"`{tree.name}` does not exist", tree.at, f"write `{tree.name.lower()}`")
    if tree.name in syntax.FUNCTIONS:
        raise ExpressionError(f"`{tree.name}` is a function", tree.at, f"write `{tree.name}(…)`")
    raise syntax.UnknownName(tree.name, tree.at)


def _item(tree: syntax.Item, scope: Mapping[str, Value]) -> Value:
    vector = evaluate(tree.vector, scope)
    if not isinstance(vector, tuple):
        raise ExpressionError(f"{kind(vector)} has no items", tree.at)
    if not -len(vector) <= tree.index < len(vector):
        raise ExpressionError(f"item {tree.index} does not exist: the vector has {len(vector)}", tree.at)
    return vector[tree.index]


def _number(tree: Expression, what: str, scope: Mapping[str, Value]) -> int | float:
    return _as_number(evaluate(tree, scope), tree, what)


def _as_number(value: Value, tree: Expression, what: str) -> int | float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
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
    return -value if tree.operator == "-" else value


def _binary(tree: syntax.Binary, scope: Mapping[str, Value]) -> Value:
    if tree.operator in ("and", "or"):
        left = _boolean(tree.left, tree.operator, scope)
        return left if left == (tree.operator == "or") else _boolean(tree.right, tree.operator, scope)
    # Evaluate each operand once: sums nest on the left, and twice each would be exponential in the number of terms.
    first = evaluate(tree.left, scope)
    if tree.operator == "+" and isinstance(first, str):
        second, most = evaluate(tree.right, scope), in_force().string
        if not isinstance(second, str):
            raise ExpressionError(f"`+` of text and {kind(second)}", tree.at)
        if len(first) + len(second) > most:
            raise ExpressionError(f"text is at most {most} characters long", tree.at, advice("string"))
        return first + second
    what = f"`{tree.operator}`"
    a, b = _as_number(first, tree.left, what), _number(tree.right, what, scope)
    if tree.operator == "**" and abs(b) > _MAX_EXPONENT:
        raise ExpressionError(f"an exponent is at most {_MAX_EXPONENT}, got {shown(b)}", tree.right.at)
    return _checked(tree, lambda: _ARITHMETIC[tree.operator](a, b), (a, b))


def _comparison(tree: syntax.Comparison, scope: Mapping[str, Value]) -> bool:
    values = [evaluate(operand, scope) for operand in tree.operands]
    for symbol, left, right in zip(tree.operators, values, values[1:], strict=False):
        if kind(left) != kind(right):
            raise ExpressionError(f"`{symbol}` of {kind(left)} and {kind(right)}", tree.at)
        if symbol not in ("==", "!=") and kind(left) not in ("a number", "text"):
            raise ExpressionError(f"`{symbol}` needs numbers or text, got {kind(left)}", tree.at)
        if not _ORDER[symbol](left, right):
            return False
    return True


def _call(tree: syntax.Call, scope: Mapping[str, Value]) -> Value:
    function = syntax.FUNCTIONS[tree.function]
    count = len(tree.arguments)
    if count < function.least or (function.most is not None and count > function.most):
        takes = f"at least {function.least}" if function.most is None else f"{function.least} or {function.most}"
        takes = str(function.least) if function.least == function.most else takes
        raise ExpressionError(f"`{tree.function}` takes {takes} numbers, got {count}", tree.at)
    arguments = [_number(argument, f"`{tree.function}`", scope) for argument in tree.arguments]
    return _checked(tree, lambda: function.apply(*arguments), arguments)


def _checked(
    tree: syntax.Binary | syntax.Call, work: Callable[[], int | float], of: Sequence[int | float]
) -> int | float:
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


class Template(Struct):
    """Pieces of text, and expressions with their start positions."""

    pieces: tuple[str | tuple[int, Expression], ...]

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
        if (count := text.count(OPENING)) > (most := in_force().string):
            at = text.index(OPENING)
            message = f"the text has {count} expressions; {most} are allowed"
            raise ExpressionError(message, (at, at + len(OPENING)), advice("string", count))
        pieces: list[str | tuple[int, Expression]] = []
        at = 0
        while (start := text.find(OPENING, at)) >= 0:
            end = _closing(text, start)
            if start > at:
                pieces.append(text[at:start])
            inside = start + len(OPENING)
            try:
                pieces.append((inside, parse(text[inside:end])))
            except ExpressionError as error:
                raise error.moved(inside) from None
            at = end + 1
        if at < len(text):
            pieces.append(text[at:])
        return cls(tuple(pieces))

    def value(self, scope: Mapping[str, Value]) -> Value:
        """Evaluate the text with these names: a single expression gives a value of any type, other texts a text."""
        values: list[Value] = []
        for piece in self.pieces:
            if isinstance(piece, str):
                values.append(piece)
                continue
            try:
                values.append(evaluate(piece[1], scope))
            except ExpressionError as error:
                raise error.moved(piece[0]) from None
        if len(values) == 1:
            return values[0]
        texts = [shown(value) for value in values]
        given = sum(len(text) for text, piece in zip(texts, self.pieces, strict=True) if text is not piece)
        if given > (most := in_force().string):
            at = next(piece[0] for piece in self.pieces if not isinstance(piece, str))
            message = f"expressions give {given} characters; {most} are allowed"
            raise ExpressionError(message, (at, at + 1), advice("string", given))
        return "".join(texts)

    def names(self) -> Iterator[Name]:
        for piece in self.pieces:
            if not isinstance(piece, str):
                at, tree = piece
                yield from (Name(each.name, (each.at[0] + at, each.at[1] + at)) for each in names(tree))

    @property
    def is_one_name(self) -> str | None:
        piece = self.pieces[0] if len(self.pieces) == 1 else ""
        return piece[1].name if not isinstance(piece, str) and isinstance(piece[1], Name) else None


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
