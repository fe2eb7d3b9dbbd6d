from __future__ import annotations

from random import Random
from typing import Any

import pytest
import yaml
from fuzz.targets import repeat
from growth.counting import calls_of
from mjcompose.base.limits import allow
from mjcompose.base.sink import Sink
from mjcompose.language.expand import Concrete, cells, expand
from mjcompose.language.recipe import DEPTHS
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, locate, to_python


def tree(text: str) -> Mapping:
    node = load(text, "recipe.yaml", sink := Sink())
    assert isinstance(node, Mapping), sink.diagnostics
    return node


def expanded(text: str, given: str = "{}", any: bool = False) -> tuple[Concrete, Sink]:
    values: dict[str, Node] = {name: value for name, (_, value) in tree(given).entries.items()}
    sink = Sink()
    return expand(tree(text), values, sink, any=any), sink


def concrete(text: str, given: str = "{}") -> Any:
    found, sink = expanded(text, given)
    assert not sink.diagnostics
    return to_python(found.document)


def test_an_entry_is_repeated_at_its_place_and_the_last_name_turns_fastest() -> None:
    text = 'sensor: {a: {}, "s${i}_${side}": {for: {i: 2, side: [left, right]}, noise: "${i / 2}"}, z: {}}'
    sensors = concrete(text)["sensor"]
    assert [*sensors] == ["a", "s0_left", "s0_right", "s1_left", "s1_right", "z"]
    assert [each.get("noise") for each in sensors.values()] == [None, 0.0, 0.0, 0.5, 0.5, None]


@pytest.mark.parametrize(
    ("values", "turns"),
    [
        ("3", [0, 1, 2]),
        ("0", []),
        ("[]", []),
        ("[left, 2, true]", ["left", 2, True]),
        ("[10deg, 0.5]", ["10.0deg", 0.5]),
        ("{hip: 1, knee: {kp: 2}}", ["hip", "knee"]),
        ("'${n}'", [0, 1]),
        ("'${n + 1}'", [0, 1, 2]),
        ("'${legs}'", ["FL", "FR"]),
        ("'${gains}'", ["hip", "knee"]),
        ("'${gains.hip}'", ["kp"]),
        ("['${n}', '${n + 1}']", [2, 3]),
    ],
)
def test_values_are_a_number_a_list_or_a_table(values: str, turns: list[object]) -> None:
    params = "{n: 2, legs: [FL, FR], gains: {default: {hip: {kp: 1}, knee: {kp: 2}}}}"
    found = concrete(f"params: {params}\nadd: [{{for: {{x: {values}}}, value: '${{x}}'}}]")["add"]
    assert [each["value"] for each in found] == turns


def test_rows_of_a_list_are_values() -> None:
    text = (
        "add: [{for: {m: [{joint: hip, at: [1, 2]}, {joint: knee, at: [3, 4]}]}, joint: '${m.joint}', y: '${m.at[1]}'}]"
    )
    assert concrete(text)["add"] == [{"joint": "hip", "y": 2}, {"joint": "knee", "y": 4}]


PLACES = {
    "attach": "attach: {{'x${{i}}': {}}}",
    "add": "add: [{}]",
    "edit": "edit: [{}]",
    "sensor": "sensor: {{'x${{i}}': {}}}",
    "asset": "asset: {{mesh: {{'x${{i}}': {}}}}}",
    "check": "check: {{'x${{i}}': {}}}",
    "keyframe": "keyframe: {{'x${{i}}': {}}}",
    "interface": "interface: {{joint: [{}]}}",
    "edit of a part": "attach: {{p: {{edit: [{}]}}}}",
    "edit of the base": "base: {{edit: [{}]}}",
    "in a model in place": "attach: {{p: {{model: {{add: [{}]}}}}}}",
    "default": "default: {{'x${{i}}': {}}}",
    "contact": "contact: {{pair: [{}]}}",
}


@pytest.mark.parametrize("place", PLACES.values(), ids=PLACES)
@pytest.mark.parametrize("word", ["for", "when"])
def test_for_may_be_where_when_may_be(place: str, word: str) -> None:
    entry = {"for": "{for: {i: 2}, k: '${i}'}", "when": "{when: false, k: 1}"}[word]
    text = place.format(entry)
    text = text if word == "for" else text.replace("${i}", "i")
    found, sink = expanded(text)
    assert not sink.diagnostics and word not in repr(to_python(found.document))


def test_a_setting_is_not_repeated() -> None:
    settings = [name for name, depth in DEPTHS.items() if depth == 1 and name not in ("add", "base")]
    for name in settings:
        _, sink = expanded(f"{name}: {{for: {{i: 2}}}}")
        assert [each.message for each in sink.errors][:1] == [f"`for` repeats an entry, and there is one `{name}`"]


def test_entries_inside_are_repeated_with_the_values_of_both() -> None:
    text = """
attach:
  "p${k}":
    for: {k: [1, 2]}
    model: {add: [{for: {j: "${k}"}, to: world, site: {name: "s${k}${j}"}}]}
    edit: [{for: {j: 2}, when: "${j < k - 1}", select: {site: "s${k}${j}"}, set: {group: "${value + k}"}}]
"""
    parts = concrete(text)["attach"]
    names = [[each["site"]["name"] for each in part["model"]["add"]] for part in parts.values()]
    assert names == [["s10"], ["s20", "s21"]]
    assert [part["edit"] for part in parts.values()] == [
        [],
        [{"select": {"site": "s20"}, "set": {"group": "${value + 2}"}}],
    ]


def test_when_leaves_out_a_turn_before_anything_in_it_is_computed() -> None:
    text = "add: [{for: {a: 3, b: 3}, when: '${a < b}', value: '${1 / (b - a)}'}]"
    assert [each["value"] for each in concrete(text)["add"]] == [1, 0.5, 1]


def test_a_key_of_a_variant_merges_before_turns_are_made() -> None:
    text = """
sensor: {"d${i}": {for: {i: 2}, type: gyro, noise: 0}}
variants: {noise: {no: {}, yes: {sensor: {"d${i}": {noise: 0.1}}}, none: {sensor: {"d${i}": null}}}}
"""
    assert concrete(text, "{noise: yes}")["sensor"] == {f"d{i}": {"type": "gyro", "noise": 0.1} for i in range(2)}
    assert concrete(text, "{noise: none}")["sensor"] == {}


def test_values_of_a_cell_make_its_turns() -> None:
    text = """
params: {n: 1}
variants: {tool: {hand: {}, none: {}}}
sensor: {"s${i}": {for: {i: "${n}"}, when: {tool: hand}}}
matrix: {axes: {n: [1, 3], tool: [hand, none]}}
"""
    counts = [
        len(expand(tree(text), cell.given, Sink()).document.entries["sensor"][1].entries)  # type: ignore[union-attr]
        for cell in cells(tree(text), "r", Sink())
    ]
    assert counts == [1, 0, 3, 0]


def test_expressions_about_an_element_keep_what_only_it_knows() -> None:
    text = """
params: {gains: {default: {hip: {kp: 20, tilt: -30deg}}}, size: [1, 2]}
edit:
  - for: {j: "${gains}", side: ["le'ft"], n: [-1]}
    select: {joint: "${j}", where: "${range[0] > n and name != side}"}
    set:
      damping: "${value * gains[j].kp + index}"
      ref: "${gains[j].tilt}"
      armature: "${size[n] + element.damping}"
      user: ["${n}", "x${n}"]
    rename: "${name}_${j}_${pi}"
"""
    entry = concrete(text)["edit"][0]
    assert entry["select"] == {"joint": "hip", "where": '${range[0] > (-1) and name != "le\'ft"}'}
    assert entry["set"] == {
        "damping": "${value * 20 + index}",
        "ref": "-30.0deg",
        "armature": "${size[(-1)] + element.damping}",  # `size` may be an attribute, too
        "user": [-1, "x-1"],
    }
    assert entry["rename"] == "${name}_${'hip'}_${pi}"


def test_an_expression_in_a_given_text_is_not_evaluated() -> None:
    given = "{t: '${value}'}"
    found, _ = expanded("params: {t: x}\nedit: [{for: {i: [a]}, set: {user: '${t}', name: '${i}${t}'}}]", given)
    entry = to_python(found.document)["edit"][0]
    assert entry["set"] == {"user": "${t}", "name": "${'a'}${t}"}


def test_a_given_text_is_not_evaluated_again() -> None:
    found, _ = expanded('sensor: {"s${i}": {for: {i: 1}, a: "${t}"}}\nparams: {t: x}', "{t: '${1 + 1}'}")
    assert to_python(found.document)["sensor"] == {"s0": {"a": "${1 + 1}"}}


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("s: {for: {i: 2}}", "`for` makes `s` twice"),
        ("'s${i // 2}': {for: {i: 2}}", "`for` makes `s0` twice"),
        ("'s${i}': {for: {i: [a, a]}}", "`for` makes `sa` twice"),
        ("s1: {}, 's${i}': {for: {i: 2}}", "`s1` exists already, and `for` makes it"),
        ("'s${i}': {for: {i: 2}}, s1: {}", "`s1` exists already, and `for` makes it"),
        ("'a${i}': {for: {i: 2}}, '${k}': {for: {k: [b, a1]}}", "`a1` exists already, and `for` makes it"),
        ("'${v}': {for: {v: [[1, 2]]}}", "a name is text, got a vector"),
        ("'${x': {for: {v: 1}}", "`${` is never closed"),
        ("'s${n}': {for: {n: 2}}", "`n` is a parameter"),
        ("'s${tool}': {for: {tool: 2}}", "`tool` is a variant"),
        ("'s${pi}': {for: {pi: 2}}", "`pi` has a meaning of its own in expressions and cannot name a value of `for`"),
        ("'s': {for: {}}", "`for` is a mapping from names to values"),
        ("'s': {for: }", "`for` is a mapping from names to values"),
        ("'s': {for: {i: }}", "`for` takes a whole number, a list or a table, got nothing"),
        ("'s': {for: {i: true}}", "`for` takes a whole number, a list or a table, got a boolean `true`"),
        ("'s': {for: {i: 1.0}}", "`for` takes a whole number, a list or a table, got a number `1.0`"),
        ("'s': {for: {i: '${1 / 0}'}}", "division by zero"),
    ],
)
def test_one_fault_is_one_error(entry: str, message: str) -> None:
    _, sink = expanded(f"params: {{n: 1}}\nvariants: {{tool: {{a: {{}}}}}}\nsensor: {{{entry}}}")
    assert [each.message for each in sink.errors] == [message]


def test_faults_of_many_turns_are_one_error_that_names_each_turn() -> None:
    found, sink = expanded("params: {t: {default: {a: 1}}}\nadd: [{for: {i: 2, k: [a, b]}, value: '${t[k] + i}'}]")
    (error,) = sink.errors
    assert error.message == "the table has no row `b`; its rows are `a`"
    assert [each.message for each in error.notes] == ["where `i` is 0, `k` is b"]
    assert [each.message for each in error.others] == ["where `i` is 1, `k` is b"]
    assert [each["value"] for each in to_python(found.document)["add"]] == [1, 2]


def test_places_are_those_of_the_entry_and_say_the_turn() -> None:
    found, _ = expanded("sensor:\n  's${i}':\n    {for: {i: 2}, noise: '${i}', type: gyro}")
    value, key = (locate(found.document, ("sensor", "s1", *path), key=not path) for path in (("noise",), ()))
    assert (value.line, key.line, value.turn, key.turn) == (3, 2, "`i` is 1", "`i` is 1")
    assert locate(found.document, ("sensor", "s1", "type")).turn == ""


def test_a_value_of_a_table_has_its_place_there() -> None:
    text = "params:\n  t:\n    default:\n      a: {x: 1}\nadd: [{for: {k: '${t}'}, value: '${t[k].x}', sum: '${t[k].x + 1}'}]"
    found, _ = expanded(text)
    source = locate(found.document, ("add", 0, "value")).source
    assert source is not None and (source.line, source.column) == (4, 14)
    assert locate(found.document, ("add", 0, "sum")).source is None


def test_conditions_about_other_builds_do_not_matter_for_all_builds() -> None:
    text = """
variants: {tool: {a: {}, b: {}}}
sensor: {"s${i}": {for: {i: 3}, when: {tool: b}, x: 1}, "t${i}": {for: {i: 3}, when: "${i > 1}", x: 1}}
"""
    found, sink = expanded(text, any=True)
    assert not sink.diagnostics and [*to_python(found.document)["sensor"]] == ["s0", "s1", "s2", "t2"]


def test_limits() -> None:
    with allow(copies=8):
        assert [each.message for each in expanded("add: [{for: {i: 3, k: 3}}]")[1].errors] == [
            "`for` has 9 turns; 8 are allowed"
        ]
    with allow(yaml_values=99):
        text = "add: [{for: {i: 10}, a: [1, 2, 3]}, {for: {i: 10}, a: [1, 2, 3]}]"
        assert [each.message for each in expanded(text)[1].errors] == ["`for` makes more than 99 values"]


def test_the_work_grows_with_the_turns() -> None:
    def work(turns: int) -> int:
        text = f"""
params: {{gains: {{default: {{hip: {{kp: 1}}}}}}}}
sensor: {{"s${{i}}": {{for: {{i: {turns}}}, noise: "${{gains['hip'].kp * i}}"}}}}
edit: [{{for: {{i: {turns}}}, select: {{site: "s${{i}}"}}, set: {{group: "${{value + i}}"}}}}]
"""
        document = tree(text)
        return calls_of(lambda: expand(document, {}, Sink()))

    work(2)
    assert work(400) < 4.3 * work(100)


@pytest.mark.parametrize("seed", range(3))
def test_repeated_entries_are_the_entries_written_out(seed: int) -> None:
    random = Random(seed)
    seeds = [each.data for each in repeat._seeds(None)]
    repeated = 0
    for _ in range(40):
        data = repeat._mutate(random.choice(seeds), random, ())
        tree_of_case = repeat._read(data)
        assert tree_of_case is not None
        found, sink = expanded(data.decode())
        written, others = expanded(yaml.safe_dump(repeat._written(tree_of_case), sort_keys=False))
        assert {each.code for each in sink.errors} == {each.code for each in others.errors}
        assert sink.errors or to_python(found.document) == to_python(written.document)
        repeated += "for:" in data.decode()
    assert repeated > 20
