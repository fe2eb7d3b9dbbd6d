"""A condition on the rows of an index, in the expression language of recipes: `payload > 2 and nv == 15`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from composer.bundle.listing import ListingError, Row
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.expr.error import ExpressionError, UnknownName
from composer.expr.evaluate import evaluate, names
from composer.expr.functions import CONSTANTS, FUNCTIONS
from composer.expr.parse import parse
from composer.expr.value import kind

T = TypeVar("T")


def with_fields(values: Mapping[str, T]) -> dict[str, T]:
    """Return the values of a row, and also each drawn field with a single column by its plain name.

    >>> with_fields({"sample": 1, "friction[cube]": 0.5, "mass[a]": 2, "mass[b]": 3})["friction"]
    0.5
    """
    columns: dict[str, list[str]] = {}
    for column in values:
        name, bracket, _ = column.partition("[")
        if bracket:
            columns.setdefault(name, []).append(column)
    alone = {name: values[found[0]] for name, found in columns.items() if len(found) == 1}
    return {**alone, **values}


class Condition:
    """A condition for all rows of an index. Raises ListingError if it is not a valid expression.

    A model without a value for a name, such as one of a cell that does not set it, does not match; `lacking` counts
    such models by name. A name that no model has is an error, which `check` raises.
    """

    def __init__(self, text: str) -> None:
        self.text = text
        try:
            self._tree = parse(text)
        except ExpressionError as error:
            raise self._fault(error) from error
        self._names = {each.name for each in names(self._tree)} - {*CONSTANTS, *FUNCTIONS}
        self._known: dict[str, None] = {}
        self.lacking: dict[str, int] = {}
        self.count = 0

    def holds(self, row: Row) -> bool:
        """Return whether a model matches. Raises ListingError."""
        self.count += 1
        self._known.update(dict.fromkeys(row.values))
        values = with_fields(row.values)
        if absent := sorted(self._names - values.keys()):
            for name in absent:
                self.lacking[name] = self.lacking.get(name, 0) + 1
            return False
        try:
            value = evaluate(self._tree, values)
        except ExpressionError as error:
            raise self._fault(error) from error
        if not isinstance(value, bool):
            raise ListingError("expression", f"`{self.text}` is {kind(value)}, and not true or false",
                               "write for instance `payload > 2`")  # fmt: skip
        return value

    def check(self) -> None:
        """Raise an error for a name that no model has. Call it after the last row."""
        for name, count in self.lacking.items():
            if count == self.count:
                words = [each for each in self._known if each.isidentifier()]
                several = [each for each in self._known if each.startswith(f"{name}[")]
                note = (
                    Note(f"drawn for several: {', '.join(several[:3])}")
                    if several
                    else exists_note("column", words, name)
                )
                raise ListingError("unknown-name", f"no model has a column `{name}`", did_you_mean(name, words),
                                   notes=(note,))  # fmt: skip

    def _fault(self, error: ExpressionError) -> ListingError:
        assert not isinstance(error, UnknownName)  # missing names are counted
        return ListingError(
            "expression", f"`{self.text}`, character {error.start + 1}: {error.message}", error.help
        )
