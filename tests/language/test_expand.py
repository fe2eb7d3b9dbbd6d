from __future__ import annotations

import math
from typing import Any

import pytest
from mjcompose.base.sink import Sink
from mjcompose.language.expand import Concrete, cells, expand
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, locate, to_python


def tree(text: str) -> Mapping:
    node = load(text, "recipe.yaml", sink := Sink())
    assert isinstance(node, Mapping), sink.diagnostics
    return node


def expanded(text: str, given: str = "{}") -> tuple[Concrete, list[str]]:
    values: dict[str, Node] = {name: value for name, (_, value) in tree(given).entries.items()}
    sink = Sink()
    return expand(tree(text), values, sink), [f"{each.code}: {each.message}" for each in sink.errors]


def concrete(text: str, given: str = "{}") -> Any:
    found, faults = expanded(text, given)
    assert not faults
    return to_python(found.document)


@pytest.mark.parametrize(
    ("declared", "given", "value"),
    [
        ("1", "{}", 1),
        ("1", "{x: 0.5}", 0.5),
        ("true", "{x: false}", False),
        ("left", "{x: right}", "right"),
        ("[1, 2, 3]", "{x: [4, 5, 6]}", [4, 5, 6]),
        ("{type: int, default: 2}", "{x: 3}", 3),
        ("{default: a, choices: [a, b]}", "{x: b}", "b"),
        ("90deg", "{}", "90.0deg"),
        ("{default: 90deg, unit: rad, max: 91deg}", "{}", "1.5707963267948966rad"),
        ("{default: 10deg, choices: [10deg, 0rad]}", "{x: 0deg}", "0.0deg"),
        ("90deg", "{x: 1}", "1deg"),
        ("{default: 0, unit: rad}", "{x: 180deg}", "3.141592653589793rad"),
        ("{type: string, default: 90deg}", "{}", "90deg"),
        ("[10deg, 0, 1rad]", "{}", ["10.0deg", "0deg", "57.29577951308232deg"]),
        ("[10deg, 20deg]", "{x: [1rad, 2]}", ["57.29577951308232deg", "2deg"]),
        ("{default: 35deg, min: 30deg}", f"{{x: {math.pi / 6!r}rad}}", "29.999999999999996deg"),
        ("{type: float, choices: [30deg, 60deg]}", f"{{x: {math.pi / 3!r}rad}}", "59.99999999999999deg"),
        ("{type: float}", "{x: 2}", 2),
        ("{default: 1, min: 0, max: 2, unit: m, doc: how far}", "{x: 2}", 2),
    ],
)
def test_a_parameter_keeps_its_type(declared: str, given: str, value: object) -> None:
    found = concrete(f"params: {{x: {declared}}}\nvalue: '${{x}}'", given)["value"]
    assert found == value and type(found) is type(value)


def test_expressions_stand_in_lists_and_text_and_keep_their_place() -> None:
    found, faults = expanded("params: {n: 2}\nadd: [{pos: [0, '${n / 4}', 1], name: 'cube_${n}'}]")
    assert not faults
    assert to_python(found.document) == {"add": [{"pos": [0, 0.5, 1], "name": "cube_2"}]}
    assert str(locate(found.document, ("add", 0, "pos", 1))) == "recipe.yaml:2:17"
    assert found.scope == {"n": 2}


def test_edits_keep_their_expressions() -> None:
    text = "params: {n: 2}\nedit: [{set: {mass: '${value * n}'}}]\nattach: {a: {edit: [{rename: '${name}_x'}]}}"
    assert concrete(text) == {
        "edit": [{"set": {"mass": "${value * n}"}}],
        "attach": {"a": {"edit": [{"rename": "${name}_x"}]}},
    }


def test_ids_are_for_merging_alone() -> None:
    assert concrete("add: [{id: a, to: world}]\nedit: [{id: b}]\nsensor: {id: {type: clock}}") == {
        "add": [{"to": "world"}],
        "edit": [{}],
        "sensor": {"id": {"type": "clock"}},
    }


VARIANTS = """
sensor: {s: {type: touch, site: a}}
params: {load: 1}
variants:
  tool: {small: {sensor: {s: {site: b}}}, large: {params: {load: 2}}}
  light: {on: {}, off: {visual: {x: 1}}}
mass: "${load}"
called: "${tool}"
"""


def test_the_first_of_an_axis_is_its_default() -> None:
    assert concrete(VARIANTS) == {"sensor": {"s": {"type": "touch", "site": "b"}}, "mass": 1, "called": "small"}


def test_a_variant_is_merged_over_the_recipe() -> None:
    assert concrete(VARIANTS, "{tool: large, light: 'off', load: 3}") == {
        "sensor": {"s": {"type": "touch", "site": "a"}},
        "visual": {"x": 1},
        "mass": 3,
        "called": "large",
    }
    assert concrete(VARIANTS, "{tool: large}")["mass"] == 2


WHEN = """
params: {load: 1, tool: a}
variants: {light: {on: {}, off: {}}}
attach: {x: {model: m, when: {light: on}}, y: {model: m, when: {load: [1, 2], tool: a}}}
add: [{to: world, when: "${load > 1}"}, {to: hand, when: true}]
sensor: {s: {type: clock, when: {light: [on, off]}}}
asset: {mesh: {m: {file: f, when: {tool: b}}}}
option: {when: {load: 2}, timestep: 1}
"""


def test_what_belongs_to_some_builds_only() -> None:
    assert concrete(WHEN) == {
        "attach": {"x": {"model": "m"}, "y": {"model": "m"}},
        "add": [{"to": "hand"}],
        "sensor": {"s": {"type": "clock"}},
        "asset": {"mesh": {}},
    }
    found = concrete(WHEN, "{light: off, load: 2, tool: b}")
    assert found["attach"] == {} and len(found["add"]) == 2
    assert found["asset"] == {"mesh": {"m": {"file": "f"}}} and found["option"] == {"timestep": 1}


@pytest.mark.parametrize(
    "place",
    [
        "attach: {x: ITEM}",
        "base: {edit: [ITEM]}",
        "attach: {x: {edit: [ITEM]}}",
        "add: [ITEM]",
        "edit: [ITEM]",
        *(f"{section}: {{x: ITEM}}" for section in "sensor actuator equality tendon keyframe default check".split()),
        *(f"asset: {{{tag}: {{x: ITEM}}}}" for tag in ("mesh", "material", "texture", "hfield", "model")),
        *(f"custom: {{{tag}: {{x: ITEM}}}}" for tag in ("numeric", "text", "tuple")),
        *(f"contact: {{{tag}: [ITEM]}}" for tag in ("exclude", "pair")),
        *(f"deformable: {{{tag}: {{x: ITEM}}}}" for tag in ("flex", "skin")),
        "extension: {plugin: {x: ITEM}}",
        *(f"{section}: ITEM" for section in "option size visual statistic compiler".split()),
    ],
)
@pytest.mark.parametrize("where", ["RECIPE", "{variants: {v: {a: RECIPE}}}"])
def test_every_item_of_a_recipe_may_belong_to_some_builds(place: str, where: str) -> None:
    def of(item: str) -> Any:
        return concrete(where.replace("RECIPE", f"{{{place}}}".replace("ITEM", item)))

    assert of("{mark: 1, when: true}") == of("{mark: 1}")
    assert "mark" not in str(of("{mark: 1, when: false}")) and "when" not in str(of("{mark: 1, when: false}"))


@pytest.mark.parametrize("section", ["sensor", "attach", "check"])
def test_what_is_called_like_a_key_of_the_language_is_an_item_like_others(section: str) -> None:
    text = f"params: {{n: 2}}\n{section}: {{where: {{a: '${{n}}'}}, edit: {{a: '${{n}}'}}, when: {{a: '${{n}}'}}}}"
    assert concrete(text) == {section: {name: {"a": 2} for name in ("where", "edit", "when")}}


@pytest.mark.parametrize(
    ("text", "given", "fault"),
    [
        ("params: {x: 1}", "{y: 2}", "unknown-name: the recipe has no parameter or variant `y`"),
        ("params: {x: {max: 1, default: 0}}", "{x: 2}", "out-of-range: parameter `x` is at most 1, got 2"),
        ("params: {x: {min: 1, default: 0}}", "{}", "out-of-range: parameter `x` is at least 1, got 0"),
        ("params: {x: 1}", "{x: true}", "wrong-type: parameter `x` is a number, got a boolean `true`"),
        ("params: {x: 1}", "{x: {a: 1}}", "wrong-type: parameter `x` is a number, got a table `{a: 1}`"),
        ("params: {x: [1, 2]}", "{x: [1]}", "wrong-length: parameter `x` has 2 numbers, got 1"),
        (
            "params: {x: {type: int, default: 1}}",
            "{x: 1.5}",
            "wrong-type: parameter `x` is a whole number, got a number `1.5`",
        ),
        (
            "params: {x: {default: a, choices: [a, b]}}",
            "{x: c}",
            "out-of-range: parameter `x` is one of `a`, `b`, got text `c`",
        ),
        (
            "params: {x: {default: 20deg, max: 30deg}}",
            "{x: 0.6rad}",
            "out-of-range: parameter `x` is at most 30.0deg, got 34.37746770784939deg",
        ),
        ("params: {x: 1}", "{x: 10deg}", "wrong-type: parameter `x` is a number, got text `10deg`"),
        (
            "params: {x: [10deg, 3]}",
            "{}",
            "bare-angle: `default` of parameter `x` has numbers with a unit and 3 without one",
        ),
        ("params: {x: {}}", "{}", "missing-key: parameter `x` has neither `default` nor `type`"),
        ("params: {x: {type: float}}\na: '${x}'", "{}", "missing-key: parameter `x` has no default and must be given"),
        ("params: {x: {type: number}}", "{}", "wrong-keyword: `type` of parameter `x` cannot be `number`"),
        ("params: {x: {default: 1, mim: 2}}", "{}", "unknown-key: parameter `x` has no key `mim`"),
        ("params: {x: {default: 1, min: 2, max: 1}}", "{}", "out-of-range: `max` of parameter `x` is below its `min`"),
        ("params: {x: '${1}'}", "{}", "wrong-type: `default` of parameter `x` cannot be an expression"),
        (
            "params: {sin: 1}",
            "{}",
            "bad-name: `sin` has a meaning of its own in expressions and cannot name a parameter",
        ),
        ("params: {a-b: 1}", "{}", "bad-name: a parameter has letters, digits and `_` in its name, got `a-b`"),
        ("params: [x]", "{}", "wrong-type: `params` is a mapping from names to parameters"),
        ("a: '${y}'", "{}", "unknown-name: the parameter `y` does not exist"),
        ("a: '${1 / 0}'", "{}", "expression: division by zero"),
        ("variants: {v: {a: {}}}", "{v: b}", "unknown-name: variant `v` has no value `b`"),
        ("variants: {v: {}}", "{}", "wrong-type: variant `v` is a mapping from its values to pieces of recipe"),
        ("variants: {v: {a: 1}}", "{}", "wrong-type: `a` of variant `v` is a piece of recipe, a mapping"),
        ("variants: {v: {a: {recipe: 1}}}", "{}", "unknown-key: `recipe` is not allowed in a variant"),
        ("variants: {v: {a: {}}}\nparams: {v: 1}", "{}", "name-clash: `v` is a variant and a parameter"),
        ("add: [{when: {y: 1}}]", "{}", "unknown-name: the variant or parameter `y` does not exist"),
        ("variants: {v: {a: {}}}\nadd: [{when: {v: b}}]", "{}", "unknown-name: variant `v` has no value `b`"),
        (
            "add: [{when: 3}]",
            "{}",
            "wrong-type: `when` is a mapping from variants and parameters to values, or one boolean expression",
        ),
        ("add: [{when: '${1 + 1}'}]", "{}", "wrong-type: `when` needs `true` or `false`"),
    ],
)
def test_one_fault_is_told_once(text: str, given: str, fault: str) -> None:
    assert expanded(text, given)[1] == [fault]


def test_what_is_wrong_is_left_out_and_the_rest_stays() -> None:
    found, faults = expanded("params: {x: 1}\na: '${y}'\nb: '${x}'\nc: [1, '${1 / 0}']")
    assert len(faults) == 2
    assert to_python(found.document) == {"b": 1}
    assert {"a", "${y}"} <= found.lost


def test_a_fault_stands_below_the_part_of_the_expression() -> None:
    sink = Sink()
    expand(tree("params: {n: 1}\na: [0, '${2 * (m + n)}']"), {}, sink)
    (fault,) = sink.errors
    assert fault.span is not None and (fault.span.line, fault.span.column, fault.span.end_column) == (2, 16, 17)


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
        ("matrix: {axes: {tool: [a]}, include: [{tool: b, light: off}]}", ["cell-a", "cell-b-off"]),
        ("matrix: {axes: {load: [0.5, 1]}, name: '${name}_${load * 2}_${light}'}", ["cell_1.0_on", "cell_2_on"]),
        ("matrix: {axes: {load: [0.0]}, name: 'p${load}'}", ["p0.0"]),
    ],
)
def test_cells(matrix: str, names: list[str]) -> None:
    assert made(matrix) == (names, [])


@pytest.mark.parametrize(
    ("matrix", "fault"),
    [
        ("{}", "`matrix` lacks `axes`"),
        ("[1]", "`matrix` expects a mapping, got a list"),
        ("{axes: {tool: a}}", "`tool` in `axes` of the matrix expects a list of values, got text `a`"),
        ("{axes: {tool: []}}", "`tool` in `axes` of the matrix expects a list of values, got an empty list"),
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
        (
            "{axes: {load: [" + "1, " * 400 + "1], tool: [" + "a, " * 300 + "a]}}",
            "the matrix has 120701 cells; 100000 are allowed",
        ),
    ],
)
def test_faults(matrix: str, fault: str) -> None:
    names, faults = made(f"matrix: {matrix}")
    assert not names and fault in faults


def test_what_is_given_holds_in_every_cell() -> None:
    node = load(
        "params: {n: {type: int}, m: 1}\nmatrix: {axes: {n: [2, 3]}, name: 'x${n}-${m}'}", "r.yaml", sink := Sink()
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
