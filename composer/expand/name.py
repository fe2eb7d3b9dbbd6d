"""The names of parameters and variants, which share the namespace of expressions."""

from __future__ import annotations

import re

from composer.diagnostics.sink import Sink
from composer.document.node import Key

# Names that expressions in `edit` define, and names that readers would confuse with parts of the language.
RESERVED = frozenset({"name", "value", "index", "parent", "base"})
_NAME = re.compile(r"[^\W\d]\w*")


def is_usable(key: Key, what: str, sink: Sink) -> bool:
    """Return whether an expression can use the name; `what` describes the named thing in messages."""
    from composer.expr.functions import CONSTANTS, FUNCTIONS
    from composer.expr.tokens import KEYWORDS

    if _NAME.fullmatch(key.name) is None:
        help = f"write `{suggested}`" if _NAME.fullmatch(suggested := re.sub(r"\W", "_", key.name)) else None
        sink.error(
            "bad-name",
            f"{what} has letters, digits and `_` in its name, got `{key.name}`",
            key.span,
            help=help,
        )
        return False
    if key.name in RESERVED or key.name in KEYWORDS or key.name in FUNCTIONS or key.name in CONSTANTS:
        sink.error(
            "bad-name",
            f"`{key.name}` has a meaning of its own in expressions and cannot name {what}",
            key.span,
            help=f"write for instance `{key.name}_`",
        )
        return False
    return True
