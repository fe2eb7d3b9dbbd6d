"""Split text into tokens."""

from __future__ import annotations

import re
from typing import NamedTuple

from composer.expr.error import ExpressionError


class Token(NamedTuple):
    """A token of an expression.

    `kind` is `number`, `text`, `name`, `end`, or for operators and keywords the token itself.
    """

    kind: str
    text: str
    start: int

    @property
    def end(self) -> int:
        return self.start + len(self.text)


KEYWORDS = frozenset({"and", "or", "not", "if", "else", "true", "false"})
_TOKEN = re.compile(
    r"""\s*(?:
        (?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)
      | (?P<name>[^\W\d]\w*)
      | (?P<text>'[^']*'|"[^"]*")
      | (?P<operator>\*\*|//|<=|>=|==|!=|[-+*/%<>()\[\],])
    )""",
    re.VERBOSE,
)
_MAX_TOKENS = 256
_MAX_DIGITS = 1000
_FOREIGN = {"&&": "and", "||": "or", "!": "not", "^": "**", "=": "=="}


def tokens(text: str) -> list[Token]:
    """Return all tokens, the last one of kind `end`. Raises `ExpressionError`."""
    found: list[Token] = []
    at = 0
    end = len(text.rstrip())
    while at < end:
        match = _TOKEN.match(text, at)
        if match is None:
            raise _unreadable(text, at + len(text[at:]) - len(text[at:].lstrip()))
        kind = str(match.lastgroup)
        token = match.group(kind)
        start = match.start(kind)
        if (
            kind == "number"
            and match.end() < end
            and (text[match.end()].isalnum() or text[match.end()] in "_.")
        ):
            raise _run_on(text, start)
        if kind == "number" and len(token) > _MAX_DIGITS:
            raise ExpressionError("the number is too long", start, match.end())
        found.append(Token(token if kind == "operator" or token in KEYWORDS else kind, token, start))
        at = match.end()
        if len(found) > _MAX_TOKENS:
            raise ExpressionError("the expression is too long", 0, len(text), "make parts of it parameters")
    found.append(Token("end", "", end))
    return found


def _unreadable(text: str, at: int) -> ExpressionError:
    if text[at] in "'\"":
        return ExpressionError(f"the text that begins with {text[at]} has no end", at, len(text))
    for foreign, ours in _FOREIGN.items():
        if text.startswith(foreign, at):
            return ExpressionError(
                f"`{foreign}` is not an operator", at, at + len(foreign), f"write `{ours}`"
            )
    if text[at] == ".":
        return ExpressionError("expressions have no attributes", at, at + 1)
    return ExpressionError(f"`{text[at]}` has no meaning in an expression", at, at + 1)


def _run_on(text: str, start: int) -> ExpressionError:
    found = re.compile(r"[\w.]+").match(text, start)
    assert found is not None
    word = found.group()
    unit = next((unit for unit in ("deg", "rad") if word.endswith(unit)), None)
    number = word.removesuffix(unit) if unit else ""
    help = f"units stand outside of expressions; write `rad({number})` for radians" if unit == "deg" else None
    return ExpressionError(f"`{word}` is not a number", start, found.end(), help)
