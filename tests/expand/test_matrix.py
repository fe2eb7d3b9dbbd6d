from __future__ import annotations

import pytest

from composer.diagnostics import Sink
from composer.document import Mapping, load
from composer.expand.matrix import cells

HEAD = "params: {load: 1}\nvariants: {tool: {a: {}, b: {}}, light: {on: {}, off: {}}}\n"


def made(matrix: str) -> tuple[list[str], list[str]]:
    node = load(HEAD + matrix, "recipe.yaml", sink := Sink())
    assert isinstance(node, Mapping)
    found = cells(node, "cell", sink)
    return [cell.name for cell in found], [each.message for each in sink.errors]


@pytest.mark.parametrize(
    ("matrix", "names"),
    [
        ("", []),
        ("matrix: {axes: {tool: [a, b], load: [1, 2]}}", ["cell-a-1", "cell-a-2", "cell-b-1", "cell-b-2"]),
        (
            "matrix: {axes: {tool: [a, b], load: [1, 2]}, exclude: [{tool: b, load: 2}]}",
            ["cell-a-1", "cell-a-2", "cell-b-1"],
        ),
        (
            "matrix: {axes: {tool: [a]}, include: [{tool: b, light: off}]}",
            ["cell-a", "cell-b-off"],
        ),
        (
            "matrix: {axes: {load: [0.5, 1]}, name: '${name}_${load * 2}_${light}'}",
            ["cell_1.0_on", "cell_2_on"],
        ),
        ("matrix: {axes: {load: [0.0]}, name: 'p${load}'}", ["p0.0"]),
    ],
)
def test_cells(matrix: str, names: list[str]) -> None:
    assert made(matrix) == (names, [])


@pytest.mark.parametrize(
    ("matrix", "fault"),
    [
        ("{}", "`matrix` lacks `axes`"),
        ("[1]", "`matrix` is a mapping"),
        ("{axes: {tool: a}}", "axis `tool` is a list of values, got no list"),
        ("{axes: {tool: []}}", "axis `tool` is a list of values, got an empty list"),
        ("{axes: {tol: [a]}}", "the recipe has no parameter or variant `tol`"),
        ("{axes: {tool: [c]}}", "variant `tool` has no value `c`"),
        ("{axes: {load: [x]}}", "parameter `load` is a number, got text `x`"),
        ("{axes: {tool: [a]}, exclude: [{load: 1}]}", "the matrix has no axis `load`"),
        ("{axes: {tool: [a]}, exclude: [{tool: b}]}", "no cell of the matrix is like this one to be excluded"),
        ("{axes: {tool: [a]}, include: [{tool: c}]}", "variant `tool` has no value `c`"),
        ("{axes: {tool: [a, b]}, name: x}", "two cells of the matrix are called `x`"),
        ("{axes: {tool: [a, a]}}", "two cells of the matrix are called `cell-a`"),
        ("{axes: {tool: [a]}, name: '${foo}'}", "the parameter `foo` does not exist"),
        ("{axes: {tool: [a]}, nam: x}", "`matrix` has no key `nam`"),
        ("{axes: {load: [" + "1, " * 400 + "1], tool: [" + "a, " * 300 + "a]}}", "the matrix has 120701 cells; 100000 are allowed"),
    ],
)  # fmt: skip
def test_faults(matrix: str, fault: str) -> None:
    names, faults = made(f"matrix: {matrix}")
    assert not names and fault in faults


def test_what_is_given_holds_in_every_cell() -> None:
    node = load(
        "params: {n: {type: int}, m: 1}\nmatrix: {axes: {n: [2, 3]}, name: 'x${n}-${m}'}",
        "r.yaml",
        sink := Sink(),
    )
    given = load("{m: 7}", "set.yaml", sink)
    assert isinstance(node, Mapping) and isinstance(given, Mapping)
    values = {name: value for name, (_, value) in given.entries.items()}
    assert [cell.name for cell in cells(node, "cell", sink, values)] == ["x2-7", "x3-7"]
    assert not sink.diagnostics


def test_what_to_put_into_the_name() -> None:
    node = load(HEAD + "matrix: {axes: {tool: [a, b]}, name: x}", "recipe.yaml", sink := Sink())
    assert isinstance(node, Mapping)
    cells(node, "cell", sink)
    (error,) = sink.errors
    assert error.help == "put `${tool}` into the name"


def test_the_name_of_the_recipe_may_depend_on_parameters() -> None:
    document = "{params: {n: 1, m: x}, matrix: {axes: {n: [2, 3]}, name: '${name}/${n}'}}"
    node = load(document, "recipe.yaml", sink := Sink())
    assert isinstance(node, Mapping)
    assert [cell.name for cell in cells(node, "a_${m}_${n}", sink)] == ["a_x_2/2", "a_x_3/3"]
