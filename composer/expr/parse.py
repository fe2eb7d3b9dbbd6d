"""Parse tokens to a tree, with Python's precedence."""

from __future__ import annotations

from composer.expr.error import ExpressionError
from composer.expr.functions import FUNCTIONS
from composer.expr.tokens import Token, tokens
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

_MAX_DEPTH = 50
_COMPARISONS = ("<", "<=", ">", ">=", "==", "!=")
# From loose to tight, each level left to right; `**` binds tighter than a sign before it and goes right to left.
_LEVELS = (("+", "-"), ("*", "/", "//", "%"))


def parse(text: str) -> Expression:
    """Return the tree of an expression. Raises `ExpressionError`."""
    parser = _Parser(tokens(text))
    if parser.next.kind == "end":
        raise ExpressionError("the expression is empty", 0, len(text), "write for instance `${2 * reach}`")
    tree = parser.choice()
    if parser.next.kind != "end":
        raise parser.unexpected("an operator")
    return tree


class _Parser:
    def __init__(self, found: list[Token]) -> None:
        self.found = found
        self.at = 0
        self.depth = 0

    @property
    def next(self) -> Token:
        return self.found[self.at]

    def take(self, *kinds: str) -> Token | None:
        token = self.next
        if token.kind not in kinds:
            return None
        self.at += 1
        return token

    def expect(self, kind: str, opened: Token) -> Token:
        token = self.take(kind)
        if token is None:
            if self.next.kind == "end":
                raise ExpressionError(f"`{opened.text}` is never closed", opened.start, opened.end)
            raise self.unexpected(f"`{kind}`")
        return token

    def unexpected(self, wanted: str) -> ExpressionError:
        token = self.next
        if token.kind == "end":
            return ExpressionError(
                f"the expression ends where {wanted} should come", max(token.start - 1, 0), token.start
            )
        help = "compare with each: `a == 1 or a == 2`" if token.text in ("in", "not") else None
        return ExpressionError(f"`{token.text}` stands where {wanted} should", token.start, token.end, help)

    def choice(self) -> Expression:
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise ExpressionError("the expression is nested too deep", self.next.start, self.next.end)
        value = self.disjunction()
        if self.take("if"):
            condition = self.disjunction()
            if self.take("else") is None:
                raise self.unexpected("`else`")
            other = self.choice()
            value = Choice(condition, value, other, value.start, other.end)
        self.depth -= 1
        return value

    def disjunction(self) -> Expression:
        left = self.conjunction()
        while self.take("or"):
            right = self.conjunction()
            left = Binary("or", left, right, left.start, right.end)
        return left

    def conjunction(self) -> Expression:
        left = self.negation()
        while self.take("and"):
            right = self.negation()
            left = Binary("and", left, right, left.start, right.end)
        return left

    def negation(self) -> Expression:
        signs = []
        while token := self.take("not"):
            signs.append(token)
        value = self.comparison()
        for token in reversed(signs):
            value = Unary("not", value, token.start, value.end)
        return value

    def comparison(self) -> Expression:
        operands = [self.level(0)]
        operators: list[str] = []
        while token := self.take(*_COMPARISONS):
            operators.append(token.kind)
            operands.append(self.level(0))
        if not operators:
            return operands[0]
        return Comparison(tuple(operators), tuple(operands), operands[0].start, operands[-1].end)

    def level(self, number: int) -> Expression:
        if number == len(_LEVELS):
            return self.signed()
        left = self.level(number + 1)
        while token := self.take(*_LEVELS[number]):
            right = self.level(number + 1)
            left = Binary(token.kind, left, right, left.start, right.end)
        return left

    def signed(self) -> Expression:
        signs = []
        while token := self.take("-", "+"):
            signs.append(token)
        value = self.power()
        for token in reversed(signs):
            value = Unary(token.kind, value, token.start, value.end)
        return value

    def power(self) -> Expression:
        base = self.item()
        if self.take("**") is None:
            return base
        self.depth += 1
        if self.depth > _MAX_DEPTH:
            raise ExpressionError("the expression is nested too deep", self.next.start, self.next.end)
        exponent = self.signed()
        self.depth -= 1
        return Binary("**", base, exponent, base.start, exponent.end)

    def item(self) -> Expression:
        value = self.atom()
        while opened := self.take("["):
            sign = self.take("-")
            token = self.take("number")
            if token is None or not token.text.isdigit():
                raise ExpressionError(
                    "an index is a whole number that is written", opened.start, self.next.end
                )
            index = -int(token.text) if sign else int(token.text)
            value = Item(value, index, value.start, self.expect("]", opened).end)
        return value

    def atom(self) -> Expression:
        if token := self.take("number"):
            return Constant(_number(token), token.start, token.end)
        if token := self.take("text"):
            return Constant(token.text[1:-1], token.start, token.end)
        if token := self.take("true", "false"):
            return Constant(token.kind == "true", token.start, token.end)
        if token := self.take("name"):
            opened = self.take("(")
            return self.call(token, opened) if opened else _name(token)
        if opened := self.take("("):
            value = self.choice()
            self.expect(")", opened)
            return value
        if opened := self.take("["):
            items, end = self.items(opened, "]")
            return Vector(items, opened.start, end)
        raise self.unexpected("a value")

    def call(self, name: Token, opened: Token) -> Expression:
        if name.text not in FUNCTIONS:
            known = ", ".join(FUNCTIONS)
            message = f"the function `{name.text}` does not exist; those that exist: {known}"
            raise ExpressionError(message, name.start, name.end)
        arguments, end = self.items(opened, ")")
        return Call(name.text, arguments, name.start, end)

    def items(self, opened: Token, closing: str) -> tuple[tuple[Expression, ...], int]:
        found: list[Expression] = []
        while not (closed := self.take(closing)):
            if found:
                if self.take(",") is None:
                    return tuple(found), self.expect(closing, opened).end
                if closed := self.take(closing):
                    break
            found.append(self.choice())
        return tuple(found), closed.end


def _number(token: Token) -> int | float:
    if token.text.isdigit():
        if len(token.text) > 19:
            raise ExpressionError("a number too large for an expression", token.start, token.end)
        return int(token.text)
    value = float(token.text)
    if value in (float("inf"), float("-inf")):
        raise ExpressionError(f"`{token.text}` is too large for a number", token.start, token.end)
    return value


def _name(token: Token) -> Expression:
    return Name(token.text, token.start, token.end)
