"""The cost of the edits and draws of a recipe. It is counted before each one is carried out, and limited."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.limits import advice, in_force
from composer.tree.expansion import written
from composer.tree.pattern import is_regular
from composer.tree.selector import Selector

# Measured: a value is written in 0.1 ms.
_LOOKS = 30
"""At how many elements a selector looks in the time in which a value is written."""
_CHARACTERS = 100
"""How many characters of a condition are evaluated in that time."""
_EXPRESSION = 500
"""How many values a regular expression counts as: it may take 2 s."""
_DRAWS, _DRAWS_OF_A_TABLE = 100, 30
"""How many draws are made in the time in which a value is written."""


@dataclass(slots=True)
class EditCost:
    """The cost of all edits of one composition so far; `ended` is set once it exceeds the limit.

    The unit is the time in which one value is written.
    """

    spent: float = 0
    ended: bool = False

    def allows(self, cost: float, sink: Sink, span: Span) -> bool:
        """Add a cost. Return False if the limit is exceeded, which is reported the first time."""
        self.spent += cost
        most = in_force().edits
        if self.spent > most and not self.ended:
            self.ended = True
            message = f"the edits up to here cost as much as {self.spent:.0f} values; {most} are allowed"
            help = advice("edits", max(2 * most, int(self.spent) + 1))
            sink.error("limit-exceeded", message, span, help=help)
        return not self.ended


def cost_of_selecting(selector: Selector, root: Node) -> float:
    """Return the cost of finding the elements of a selector."""
    each = list(selector.all())
    looks = 0 if selector.is_one_name else len(each) * written(root)
    expressions = sum(is_regular(name) for one in each for name in (one.pattern, one.dclass or ""))
    return _EXPRESSION * expressions + looks / _LOOKS


def cost_of_condition(where: Mapping[str, object] | str | None) -> float:
    """Return the cost of evaluating a condition on one element."""
    return len(where) / _CHARACTERS if isinstance(where, str) else len(where or ())


def count_values(value: Any) -> int:
    """Return how many values an entry writes for each element.

    >>> count_values({"set": {"size": [0.1, 0.2], "rgba": [1, 0, 0, 1]}, "remove": True})
    3
    """
    return sum(map(count_values, value.values())) if isinstance(value, Mapping) else 1


def cost_of_draws(samples: int, tabled: bool) -> float:
    """Return the cost of checking the draws of all samples for one element, and of tabulating them."""
    return 1 + samples / (_DRAWS_OF_A_TABLE if tabled else _DRAWS)
