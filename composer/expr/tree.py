"""The nodes of a parsed expression; `start` and `end` are positions in the text."""

from __future__ import annotations

from composer.dataclass import dataclass
from composer.expr.value import Value


@dataclass(frozen=True, slots=True)
class Constant:
    value: Value
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Name:
    name: str
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Item:
    """An item of a vector: `vector[index]`."""

    vector: Expression
    index: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Vector:
    items: tuple[Expression, ...]
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Unary:
    operator: str
    operand: Expression
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Binary:
    """Arithmetic, `and` and `or`."""

    operator: str
    left: Expression
    right: Expression
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Comparison:
    """A comparison such as `a < b <= c`: it has one operand more than operators."""

    operators: tuple[str, ...]
    operands: tuple[Expression, ...]
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Choice:
    """A conditional expression: `yes if condition else no`."""

    condition: Expression
    yes: Expression
    no: Expression
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Call:
    function: str
    arguments: tuple[Expression, ...]
    start: int
    end: int


Expression = Constant | Name | Item | Vector | Unary | Binary | Comparison | Choice | Call
