"""Write entries of a recipe that differ in a pattern as one entry with `for`."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from itertools import groupby, pairwise, product
from typing import Any, NamedTuple

from mjcompose.base.sink import Sink
from mjcompose.language.repeat import FOR
from mjcompose.text.dump import in_brackets
from mjcompose.text.load import load
from mjcompose.text.node import OPENING, to_python
from mjcompose.tools.importing.elements import SectionEntry

FEWEST = 5
"""The smallest number of entries that become one."""
_TOKEN = re.compile(r"\d+\.\d*|[0-9]+|[^\W\d_]+|.", re.DOTALL)
_NAMES = ("i", "j", "k")
Values = tuple[Any, ...]
"""The values of one place, by entry."""


class _Written(NamedTuple):
    """An entry and its data: the key, or None in a list, and the value."""

    entry: SectionEntry
    key: str | None
    value: Any

    @property
    def shape(self) -> tuple[object, ...]:
        """Equal for entries that may differ in a pattern."""
        return self.entry.section, self.entry.group, self.entry.rank, _shape(self.key), _shape(self.value)


def folded(entries: Sequence[SectionEntry]) -> list[SectionEntry]:
    """Return the entries with each run of at least `FEWEST` that differ in a pattern as one.

    >>> entries = [SectionEntry("sensor", f"s{i}: {{type: force, site: arm{i + 1}/tip}}") for i in range(5)]
    >>> print(folded(entries)[0].text)
    "s${i}": {for: {i: 5}, type: force, site: "arm${i + 1}/tip"}
    """
    result: list[SectionEntry] = []
    for _, run in groupby(map(_read, entries), key=_shape_of):
        written = list(run)
        one = _one([each for each in written if isinstance(each, _Written)]) if len(written) >= FEWEST else None
        result += [each.entry if isinstance(each, _Written) else each for each in written] if one is None else [one]
    return result


def _read(entry: SectionEntry) -> _Written | SectionEntry:
    if entry.note is not None or OPENING in entry.text:
        return entry
    sink = Sink()
    tree = load(entry.text, "", sink)
    data = None if tree is None or sink.has_errors else to_python(tree)
    if not isinstance(data, dict):
        return entry
    if len(data) == 1 and isinstance(value := next(iter(data.values())), dict) and not entry.text.startswith("{"):
        return _Written(entry, next(iter(data)), value)
    return _Written(entry, None, data)


def _shape_of(each: _Written | SectionEntry) -> object:
    return each.shape if isinstance(each, _Written) else id(each)


def _shape(value: Any) -> object:
    if isinstance(value, dict):
        return tuple((key, _shape(inner)) for key, inner in value.items())
    if isinstance(value, list):
        return tuple(map(_shape, value))
    if isinstance(value, str):
        return tuple("" if token.isalnum() else token for token in _tokens(value))
    return "number" if isinstance(value, int | float) and not isinstance(value, bool) else value


def _tokens(text: str) -> list[str]:
    return _TOKEN.findall(text)


def _one(written: Sequence[_Written]) -> SectionEntry | None:
    """Return the entry that repeats for all these entries, or None if they differ in no pattern."""
    keys = [each.key for each in written]
    whole = [each.value if each.key is None else [each.key, each.value] for each in written]
    if not written or len({in_brackets(each) for each in whole}) < len(written):
        return None
    names = _Names.of(list(_differences(whole)))
    if names is None:
        return None
    template = names.template(whole)
    if template is None:
        return None
    key, value = (None, template) if keys[0] is None else template
    repeated = {FOR: names.values, **value}
    text = in_brackets(repeated) if key is None else in_brackets({key: repeated})[1:-1]
    return replace(written[0].entry, text=text)


def _differences(values: Sequence[Any]) -> Iterator[Values]:
    """Yield the texts that differ, place by place; numbers are not texts."""
    first = values[0]
    if isinstance(first, dict):
        for key in first:
            yield from _differences([value[key] for value in values])
    elif isinstance(first, list):
        for items in zip(*values, strict=True):
            yield from _differences(items)
    elif isinstance(first, str):
        for tokens in zip(*map(_tokens, values), strict=True):
            if len(set(tokens)) > 1:
                yield tokens


class _Names:
    """The names of a `for`, each with its value in every entry; `values` is the text of the `for`."""

    def __init__(self, columns: Sequence[Values]) -> None:
        self.columns = dict(zip(_NAMES, columns, strict=False))
        self.values: dict[str, Any] = {}
        for name, column in self.columns.items():
            different = list(dict.fromkeys(column))
            self.values[name] = len(different) if different == list(range(len(different))) else different

    @classmethod
    def of(cls, differences: Iterable[Values]) -> _Names | None:
        """Return names whose combinations, in their order, are the entries; None if there are none."""
        columns = dict.fromkeys(_counted(each) for each in differences)
        slowest_first = sorted(columns, key=lambda column: sum(a != b for a, b in pairwise(column)))
        apart: list[Values] = []
        for column in slowest_first:
            if not any(_follows(column, other) for other in apart):
                apart.append(column)
        different = [tuple(dict.fromkeys(column)) for column in apart]
        if not apart or len(apart) > len(_NAMES) or math.prod(map(len, different)) != len(apart[0]):
            return None
        return cls(apart) if list(product(*different)) == list(zip(*apart, strict=True)) else None

    def template(self, values: Sequence[Any]) -> Any:
        """Return the value that gives each of these, with expressions; None if there is none."""
        first = values[0]
        if isinstance(first, dict):
            inner = {key: self.template([value[key] for value in values]) for key in first}
            return None if any(value is None for value in inner.values()) else inner
        if isinstance(first, list):
            items = [self.template(each) for each in zip(*values, strict=True)]
            return None if any(item is None for item in items) else items
        if isinstance(first, str):
            pieces = [self._token(tokens) for tokens in zip(*map(_tokens, values), strict=True)]
            return None if any(piece is None for piece in pieces) else "".join(map(str, pieces))
        return first if all(value == first for value in values) else self._number(tuple(values))

    def _token(self, tokens: Values) -> str | None:
        if len(set(tokens)) == 1:
            return str(tokens[0])
        column = _counted(tokens)
        for name, own in self.columns.items():
            if column == own:
                return f"${{{name}}}"
            if _follows(column, own):
                offset = column[0] - own[0]
                return f"${{{name} {'+' if offset > 0 else '-'} {abs(offset)}}}"
        return None

    def _number(self, values: Values) -> str | None:
        """Return the expression of numbers in equal steps. A quotient of whole numbers gives each of them exactly."""
        numbers = [Decimal(repr(value)) for value in values]
        for name, own in self.columns.items():
            if not all(isinstance(each, int) for each in own):
                continue
            pairs = zip(pairwise(numbers), pairwise(own), strict=True)
            step = next((second - first) / (right - left) for (first, second), (left, right) in pairs if left != right)
            start = numbers[0] - step * own[0]
            if any(start + step * index != number for index, number in zip(own, numbers, strict=True)):
                continue
            text = _quotient(name, step, start)
            if text is not None:
                return f"${{{text}}}"
        return None


_MOST_DIGITS = 9


def _quotient(name: str, step: Decimal, start: Decimal) -> str | None:
    """Return `start + step * name` with whole numbers, or None for numbers with many digits.

    >>> _quotient("i", Decimal("0.25"), Decimal("-1")), _quotient("i", Decimal("2"), Decimal("0"))
    ('(25 * i - 100) / 100', '2 * i')
    """
    digits = max(0, *(-int(each.normalize().as_tuple().exponent) for each in (step, start)))
    if digits > _MOST_DIGITS:
        return None
    divisor = 10**digits
    factor = int(step * divisor)
    rest = int(start * divisor)
    text = name if factor == 1 else f"{factor} * {name}"
    if rest:
        text += f" {'+' if rest > 0 else '-'} {abs(rest)}"
    if divisor == 1:
        return text
    return f"({text}) / {divisor}" if rest else f"{text} / {divisor}"


def _changes(column: Values) -> int:
    return sum(first != second for first, second in pairwise(column))


def _counted(tokens: Values) -> Values:
    """Return whole numbers as numbers, if an expression gives the same texts for them."""
    numbers = [int(token) for token in tokens if token.isdecimal() and str(int(token)) == token]
    return tuple(numbers) if len(numbers) == len(tokens) else tokens


def _follows(column: Values, other: Values) -> bool:
    """Return whether the values of a place are those of another place plus a number."""
    if column == other:
        return True
    are_numbers = all(isinstance(each, int) for each in (*column, *other))
    return are_numbers and len({a - b for a, b in zip(column, other, strict=True)}) == 1
