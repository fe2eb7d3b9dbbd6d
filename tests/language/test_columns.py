from __future__ import annotations

import pytest
from language.test_repeat import expanded
from mjcompose.language.columns import fault_of_columns
from mjcompose.text.expression import DataTable


def told(declared: str, given: str = "{}") -> list[str]:
    _, sink = expanded(f"params: {{t: {declared}}}", given)
    return [f"{each.span}: {each.message}" for each in sink.errors]


@pytest.mark.parametrize(
    "table",
    [
        "{}",
        "{a: 1, b: {x: 1}}",
        "{a: {x: 1, y: 2}, b: {y: 2}, c: {}}",
        "{a: {x: 0}, b: {x: 30deg}, c: {x: 1rad}}",
        "{a: {x: 30deg}, b: {x: 0}}",
        "{a: {x: [1, 2]}, b: {x: [30, 4, 5]}}",
        "{a: {x: [a, 2]}, b: {x: [30, c]}}",
        "{a: {x: {y: 1}}, b: {x: {z: c}}}",
        "{a: {x: 1}, b: {x: 2.5}}",
    ],
)
def test_tables_that_are_right(table: str) -> None:
    assert told(f"{{default: {table}}}") == told("{type: table}", f"{{t: {table}}}") == []


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("{a: {x: 1}, b: {y: 1}}", "row `b` of parameter `t` has no column `y`; its columns are `x`"),
        ("{a: {x: 1}, b: 2}", "row `b` of parameter `t` has the columns `x`, got a number `2`"),
        ("{a: {x: 1}, b: {x: 1k}}", "`x` of row `b` of parameter `t` is text `1k`"),
        ("{a: {x: 1}, b: {x: true}}", "`x` of row `b` of parameter `t` is a boolean `true`"),
        ("{a: {x: 1}, b: {x: 30deg}}", "`x` of row `b` of parameter `t` is an angle `30.0deg`"),
        ("{a: {x: left}, b: {x: 0}}", "`x` of row `b` of parameter `t` is a number `0`"),
        ("{a: {x: 1}, b: {x: [1]}}", "`x` of row `b` of parameter `t` is a vector `[1]`"),
        ("{a: {x: [1, 2]}, b: {x: [1, 2k]}}", "`x` of row `b` of parameter `t` is a vector `[1, 2k]`"),
    ],
)
def test_the_first_row_declares_the_columns_and_their_types(table: str, message: str) -> None:
    place = f"recipe.yaml:1:{4 + table.index('b: ') + 4}"
    (found,) = told("{type: table}", f"{{t: {table}}}")
    assert found.endswith(message) and found.startswith("recipe.yaml:1:")
    assert int(found.split(":")[2]) >= int(place.split(":")[2]) - 1  # in the row, not at the table


def test_the_default_declares_the_columns_of_a_given_table() -> None:
    declared = "{default: {a: {kp: 1, name: x}}}"
    assert told(declared, "{t: {b: {kp: 2, name: y}}}") == []
    assert told(declared, "{t: {b: {kq: 2}}}") == [
        "recipe.yaml:1:10: row `b` of parameter `t` has no column `kq`; its columns are `kp`, `name`"
    ]
    assert told(declared, "{t: {b: {kp: 2k}}}") == ["recipe.yaml:1:14: `kp` of row `b` of parameter `t` is text `2k`"]


def test_listed_columns_may_have_any_type() -> None:
    declared = "{type: table, columns: [kp, kd]}"
    assert told(declared, "{t: {a: {kp: 1}, b: {kp: auto, kd: 2}}}") == []
    assert told(declared, "{t: {a: {kp: 1, ki: 2}}}") == [
        "recipe.yaml:1:17: row `a` of parameter `t` has no column `ki`; its columns are `kp`, `kd`"
    ]
    assert told(declared, "{t: {a: 1}}")[0].endswith(
        "row `a` of parameter `t` has the columns `kp`, `kd`, got a number `1`"
    )


def test_a_table_from_python_has_no_places() -> None:
    table = DataTable({"a": DataTable({"x": 1}), "b": DataTable({"y": 1})})
    fault = fault_of_columns("t", table, None, None)
    assert (
        fault is not None
        and fault.span is None
        and fault.help == "list all columns next to its `default`: `columns: [x, y]`"
    )


def test_the_columns_of_a_wide_table_are_looked_up_once_each() -> None:
    compared = 0

    class Name(str):
        __slots__ = ()
        __hash__ = str.__hash__

        def __eq__(self, other: object) -> bool:
            nonlocal compared
            compared += 1
            return str.__eq__(self, other)

    def row() -> DataTable:
        return DataTable({Name(f"column{number}"): number for number in range(300)})

    table = DataTable({"first": row(), "second": row()})
    assert fault_of_columns("gains", table, None, None) is None
    assert compared < 10 * 300
