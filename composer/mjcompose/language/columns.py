"""The columns of a table: a parameter lists the columns of each row, or the first row declares them."""

from __future__ import annotations

from collections.abc import Collection

from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.suggest import did_you_mean
from mjcompose.text.expression import Angle, DataTable, Value, kind, leaves, with_units


def fault_of_columns(
    parameter: str, value: Value, columns: Collection[str] | None, default: Value | None
) -> Diagnostic | None:
    """Return the first error in the rows of a table, or None.

    Without `columns`, the first row of the default declares them, or the first row of a table without a default. It
    then also declares the type of each column. A table whose first row is a single value has no columns.
    """
    if not isinstance(value, DataTable):
        return None
    model = None if columns is not None else _first_row(default) or _first_row(value)
    declared = columns if model is None else model
    if declared is None:
        return None
    names = dict.fromkeys(declared)  # keeps the order for messages, and a wide table looks up each of its columns
    for name, row in value.items():
        fault = _fault_of_row(parameter, name, row, names, value)
        if fault is None and model is not None and isinstance(row, DataTable):
            fault = _fault_of_type(parameter, name, row, model)
        if fault is not None:
            return fault
    return None


def _first_row(table: Value | None) -> DataTable | None:
    row = next(iter(table.values()), None) if isinstance(table, DataTable) else None
    return row if isinstance(row, DataTable) else None


def _fault_of_row(
    parameter: str, name: str, row: Value, columns: Collection[str], table: DataTable
) -> Diagnostic | None:
    listed = ", ".join(f"`{column}`" for column in columns)
    if not isinstance(row, DataTable):
        message = f"row `{name}` of parameter `{parameter}` has the columns {listed}, got {quoted(row)}"
        place = table.places.get(name)
        return Diagnostic("wrong-type", message, None if place is None else place.value)
    for column in row:
        if column not in columns:
            message = f"row `{name}` of parameter `{parameter}` has no column `{column}`; its columns are {listed}"
            every = ", ".join([*columns, column])
            help = did_you_mean(column, columns) or f"list all columns next to its `default`: `columns: [{every}]`"
            place = row.places.get(column)
            return Diagnostic("unknown-key", message, None if place is None else place.name, help=help)
    return None


def _fault_of_type(parameter: str, name: str, row: DataTable, model: DataTable) -> Diagnostic | None:
    for column, value in row.items():
        if _are_alike(model[column], value):
            continue
        message = f"`{column}` of row `{name}` of parameter `{parameter}` is {quoted(value)}"
        place = row.places.get(column)
        first = model.places.get(column)
        note = Note(f"in the first row it is {quoted(model[column])}", None if first is None else first.value)
        return Diagnostic("wrong-type", message, None if place is None else place.value, notes=(note,))
    return None


def _are_alike(first: Value, other: Value) -> bool:
    """Return whether two values may be in one column. A 0 needs no unit, so it is alike to every angle.

    >>> _are_alike(1, 2.5), _are_alike(0, Angle(1, "deg")), _are_alike(1, "2k"), _are_alike((0, 1), (0, "x"))
    (True, True, False, False)
    """
    if isinstance(first, tuple) and isinstance(other, tuple):
        return not all(map(_is_number, leaves(first))) or all(map(_is_number, leaves(other)))
    if _is_zero(first) or _is_zero(other):
        return _is_number(first) and _is_number(other)
    return kind(first) == kind(other)


def _is_number(value: Value) -> bool:
    return isinstance(value, int | float | Angle) and not isinstance(value, bool)


def _is_zero(value: Value) -> bool:
    return _is_number(value) and value == 0


def place_in(value: Value, leaf: Value) -> Span | None:
    """Return where a table has a single value, by its identity; None if no table has it alone."""
    if not isinstance(value, DataTable):
        return None
    for name, row in value.items():
        if name in value.places and any(each is leaf for each in leaves(row)):
            return place_in(row, leaf) or value.places[name].value
    return None


def quoted(value: Value) -> str:
    """Return the kind of a value, and the value if it is short."""
    text = with_units(value)
    return f"{kind(value)} `{text}`" if len(text) <= _LONGEST else kind(value)


_LONGEST = 40
