"""Evaluate a tree. Evaluation of any tree ends soon, with a value or an `ExpressionError`."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

from composer.expr.error import ExpressionError, UnknownName
from composer.expr.functions import CONSTANTS, FUNCTIONS, ArgumentError
from composer.expr.tree import (
    Binary,
    Call,
    Choice,
    Comparison,
    Constant,
    Expression,
    Item,
    Name,
    Unary,
    Vector,
)
from composer.expr.value import MAX_INTEGER, Value, kind, shown
from composer.limits import advice, in_force

_MAX_EXPONENT = 1024
_ARITHMETIC: Mapping[str, Callable[[float, float], float]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
    "//": operator.floordiv,
    "%": operator.mod,
    "**": operator.pow,
}
_ORDER: Mapping[str, Callable[[Value, Value], bool]] = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


def evaluate(tree: Expression, scope: Mapping[str, Value]) -> Value:
    """Return the value with the names of `scope`. Raises `ExpressionError`."""
    if isinstance(tree, Constant):
        return tree.value
    if isinstance(tree, Name):
        return _name(tree, scope)
    if isinstance(tree, Item):
        return _item(tree, scope)
    if isinstance(tree, Vector):
        return tuple(evaluate(item, scope) for item in tree.items)
    if isinstance(tree, Unary):
        return _unary(tree, scope)
    if isinstance(tree, Comparison):
        return _comparison(tree, scope)
    if isinstance(tree, Choice):
        chosen = tree.yes if _boolean(tree.condition, "if", scope) else tree.no
        return evaluate(chosen, scope)
    if isinstance(tree, Call):
        return _call(tree, scope)
    return _binary(tree, scope)


def names(tree: Expression) -> Iterator[Name]:
    """Yield every name in an expression, including constants such as `pi`."""
    if isinstance(tree, Name):
        yield tree
    for child in _children(tree):
        yield from names(child)


def _children(tree: Expression) -> Iterable[Expression]:
    if isinstance(tree, Item):
        return (tree.vector,)
    if isinstance(tree, Vector):
        return tree.items
    if isinstance(tree, Unary):
        return (tree.operand,)
    if isinstance(tree, Binary):
        return (tree.left, tree.right)
    if isinstance(tree, Comparison):
        return tree.operands
    if isinstance(tree, Choice):
        return (tree.condition, tree.yes, tree.no)
    return tree.arguments if isinstance(tree, Call) else ()


def _name(tree: Name, scope: Mapping[str, Value]) -> Value:
    if tree.name in scope:
        return scope[tree.name]
    if tree.name in CONSTANTS:
        return CONSTANTS[tree.name]
    if tree.name.lower() in ("true", "false"):
        raise ExpressionError(
            f"`{tree.name}` does not exist", tree.start, tree.end, f"write `{tree.name.lower()}`"
        )
    if tree.name in FUNCTIONS:
        raise ExpressionError(f"`{tree.name}` is a function", tree.start, tree.end, f"write `{tree.name}(…)`")
    raise UnknownName(tree.name, tree.start, tree.end)


def _item(tree: Item, scope: Mapping[str, Value]) -> Value:
    vector = evaluate(tree.vector, scope)
    if not isinstance(vector, tuple):
        raise ExpressionError(f"{kind(vector)} has no items", tree.start, tree.end)
    if not -len(vector) <= tree.index < len(vector):
        raise ExpressionError(
            f"item {tree.index} does not exist: the vector has {len(vector)}", tree.start, tree.end
        )
    return vector[tree.index]


def _number(tree: Expression, what: str, scope: Mapping[str, Value]) -> int | float:
    return _as_number(evaluate(tree, scope), tree, what)


def _as_number(value: Value, tree: Expression, what: str) -> int | float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ExpressionError(f"{what} needs a number, got {kind(value)}", tree.start, tree.end)
    return value


def _boolean(tree: Expression, what: str, scope: Mapping[str, Value]) -> bool:
    value = evaluate(tree, scope)
    if not isinstance(value, bool):
        raise ExpressionError(f"`{what}` needs a boolean, got {kind(value)}", tree.start, tree.end)
    return value


def _unary(tree: Unary, scope: Mapping[str, Value]) -> Value:
    if tree.operator == "not":
        return not _boolean(tree.operand, "not", scope)
    value = _number(tree.operand, f"`{tree.operator}`", scope)
    return -value if tree.operator == "-" else value


def _binary(tree: Binary, scope: Mapping[str, Value]) -> Value:
    if tree.operator in ("and", "or"):
        left = _boolean(tree.left, tree.operator, scope)
        if left == (tree.operator == "or"):
            return left
        return _boolean(tree.right, tree.operator, scope)
    # Evaluate each operand once: sums nest on the left, and twice each would be exponential in the number of terms.
    first = evaluate(tree.left, scope)
    if tree.operator == "+" and isinstance(first, str):
        return _joined(tree, first, evaluate(tree.right, scope))
    what = f"`{tree.operator}`"
    a, b = _as_number(first, tree.left, what), _number(tree.right, what, scope)
    if tree.operator == "**" and abs(b) > _MAX_EXPONENT:
        raise ExpressionError(
            f"an exponent is at most {_MAX_EXPONENT}, got {shown(b)}", tree.right.start, tree.right.end
        )
    return _checked(tree, lambda: _ARITHMETIC[tree.operator](a, b), (a, b))


def _joined(tree: Binary, left: str, right: Value) -> str:
    if not isinstance(right, str):
        raise ExpressionError(f"`+` of text and {kind(right)}", tree.start, tree.end)
    most = in_force().string
    if len(left) + len(right) > most:
        raise ExpressionError(
            f"text is at most {most} characters long", tree.start, tree.end, advice("string")
        )
    return left + right


def _comparison(tree: Comparison, scope: Mapping[str, Value]) -> bool:
    values = [evaluate(operand, scope) for operand in tree.operands]
    for symbol, left, right in zip(tree.operators, values, values[1:], strict=False):
        if kind(left) != kind(right):
            message = f"`{symbol}` of {kind(left)} and {kind(right)}"
            raise ExpressionError(message, tree.start, tree.end)
        if symbol not in ("==", "!=") and kind(left) not in ("a number", "text"):
            raise ExpressionError(f"`{symbol}` needs numbers or text, got {kind(left)}", tree.start, tree.end)
        if not _ORDER[symbol](left, right):
            return False
    return True


def _call(tree: Call, scope: Mapping[str, Value]) -> Value:
    function = FUNCTIONS[tree.function]
    count = len(tree.arguments)
    if count < function.least or (function.most is not None and count > function.most):
        wanted = (
            f"at least {function.least}"
            if function.most is None
            else str(function.least) if function.least == function.most else f"{function.least} or {function.most}"
        )  # fmt: skip
        raise ExpressionError(f"`{tree.function}` takes {wanted} numbers, got {count}", tree.start, tree.end)
    arguments = [_number(argument, f"`{tree.function}`", scope) for argument in tree.arguments]
    return _checked(tree, lambda: function.apply(*arguments), arguments)


def _checked(tree: Binary | Call, work: Callable[[], int | float], of: Sequence[int | float]) -> int | float:
    """Compute a number; a result that is not finite, or too large, is an error of the expression.

    `of` are the operands.
    """
    try:
        value = work()
    except ZeroDivisionError:
        raise ExpressionError("division by zero", tree.start, tree.end) from None
    except OverflowError:
        raise ExpressionError("the result is too large", tree.start, tree.end) from None
    except (ValueError, TypeError) as error:
        name = tree.function if isinstance(tree, Call) else tree.operator
        numbers = ", ".join(map(shown, of))
        reason = str(error) if isinstance(error, ArgumentError) else f"it is not defined at {numbers}"
        raise ExpressionError(f"`{name}`: {reason}", tree.start, tree.end) from None
    if isinstance(value, complex):
        message = f"the root of a negative number, {shown(of[0])} to the power of {shown(of[1])}"
        raise ExpressionError(message, tree.start, tree.end)
    if isinstance(value, int):
        if abs(value) >= MAX_INTEGER:
            raise ExpressionError("the result is too large for a whole number", tree.start, tree.end)
    elif not math.isfinite(value):
        raise ExpressionError("the result is not a finite number", tree.start, tree.end)
    return value
