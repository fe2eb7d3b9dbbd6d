"""Text that contains `${…}`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import lru_cache

from composer.dataclass import dataclass
from composer.expr.error import ExpressionError
from composer.expr.evaluate import evaluate, names
from composer.expr.opening import OPENING
from composer.expr.parse import parse
from composer.expr.tree import Expression, Name
from composer.expr.value import Value, shown
from composer.limits import advice, in_force


@dataclass(frozen=True, slots=True)
class Template:
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
        # Expressions give at least a character as a rule, and counting the characters of too many would take
        # minutes.
        if (count := text.count(OPENING)) > (most := in_force().string):
            at = text.index(OPENING)
            message = f"the text has {count} expressions; {most} are allowed"
            raise ExpressionError(message, at, at + len(OPENING), advice("string", count))
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
        """Evaluate the text with these names: a single expression gives a value of any type, anything else a text."""
        values = [piece if isinstance(piece, str) else _evaluated(piece, scope) for piece in self.pieces]
        if len(values) == 1:
            return values[0]
        texts = [shown(value) for value in values]
        given = sum(len(text) for text, piece in zip(texts, self.pieces, strict=True) if text is not piece)
        if given > (most := in_force().string):
            at = next(piece[0] for piece in self.pieces if not isinstance(piece, str))
            message = f"expressions give {given} characters; {most} are allowed"
            raise ExpressionError(message, at, at + 1, advice("string", given))
        return "".join(texts)

    def names(self) -> Iterator[Name]:
        """Yield the names in the expressions, with their positions in the whole text."""
        for piece in self.pieces:
            if not isinstance(piece, str):
                at, tree = piece
                yield from (Name(each.name, each.start + at, each.end + at) for each in names(tree))

    @property
    def is_one_name(self) -> str | None:
        """The name, if the text is only `${name}`."""
        piece = self.pieces[0] if len(self.pieces) == 1 else ""
        return piece[1].name if not isinstance(piece, str) and isinstance(piece[1], Name) else None


def _evaluated(piece: tuple[int, Expression], scope: Mapping[str, Value]) -> Value:
    at, tree = piece
    try:
        return evaluate(tree, scope)
    except ExpressionError as error:
        raise error.moved(at) from None


def _closing(text: str, start: int) -> int:
    """Return the position of the brace that closes the one at `start`, ignoring braces in quotes."""
    quote = ""
    for at in range(start + len(OPENING), len(text)):
        character = text[at]
        if quote:
            quote = "" if character == quote else quote
        elif character in "'\"":
            quote = character
        elif character == "}":
            return at
    raise ExpressionError("`${` is never closed", start, len(text), "put `}` behind the expression")
