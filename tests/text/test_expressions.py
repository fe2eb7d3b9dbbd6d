from __future__ import annotations

import math
import time

import pytest
from hypothesis import given, strategies as st
from mjcompose.text.evaluate import Template, bound
from mjcompose.text.expression import Angle, DataTable, ExpressionError, Value, shown, with_units

SCOPE: dict[str, Value] = {
    "reach": 0.45,
    "n": 3,
    "left": True,
    "side": "left",
    "v": (1, 2.5),
    "t": DataTable({"hip": DataTable({"kp": 20, "not": (1, 2)}), "knee-1": DataTable({"kp": 40})}),
}


def value(text: str) -> Value:
    return Template.parse(text).value(SCOPE)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("${1 + 2 * 3 ** 2}", 19),
        ("${-2 ** 2}", -4),
        ("${2 ** -1}", 0.5),
        ("${2 ** 3 ** 2}", 512),
        ("${7 // 2 + 7 % 2}", 4),
        ("${(1 + 2) * 3}", 9),
        ("${n / 2}", 1.5),
        ("${reach}", 0.45),
        ("${1e-3}", 0.001),
        ("${v[-1] * v[0]}", 2.5),
        ("${[n, 2 * n]}", (3, 6)),
        ("${1 < n <= 3 and not false}", True),
        ("${false and 1 / 0 > 1}", False),
        ("${'a' if side == 'left' else 'b'}", "a"),
        ("${1 if left else 2 if not left else 3}", 1),
        ("${clamp(5, 0, 1)}", 1),
        ("${rad(180) == pi}", True),
        ("${round(2.5)}", 2),
        ("${round(2.567, 2)}", 2.57),
        ("${hypot(3, 4)}", 5.0),
        ("pad_${side}_${n}", "pad_left_3"),
        ("${reach}m", "0.45m"),
        ("${'}' + '${'}", "}${"),
        ("${t.hip.kp + t['knee-1'].kp}", 60),
        ("${t['h' + 'ip'].not[n - 2]}", 2),
        ("${(v)[-(n - 1)]}", 1),
        ("${(t)['hip'] == t.hip}", True),
        ("${[1, 2][0]}", 1),
    ],
)
def test_values(text: str, expected: Value) -> None:
    found = value(text)
    assert found == expected and type(found) is type(expected)


@pytest.mark.parametrize(
    ("text", "part", "message"),
    [
        ("${1 / (n - 3)}", "1 / (n - 3", "division by zero"),
        ("${2 ** 2000}", "2000", "an exponent is at most 1024, got 2000"),
        ("${10 ** 30}", "10 ** 30", "the result is too large for a whole number"),
        ("${1e300 * 1e300}", "1e300 * 1e300", "the result is not a finite number"),
        ("${sqrt(-1)}", "sqrt(-1)", "`sqrt`: it is not defined at -1"),
        ("${log(0)}", "log(0)", "`log`: it is not defined at 0"),
        ("${acos(2)}", "acos(2)", "`acos`: it is not defined at 2"),
        ("${(-1) ** 0.5}", "-1) ** 0.5", "the root of a negative number, -1 to the power of 0.5"),
        ("${left + 1}", "left", "`+` needs a number, got a boolean"),
        ("${side * 2}", "side", "`*` needs a number, got text"),
        ("${side < 1}", "side < 1", "`<` of text and a number"),
        ("${v < v}", "v < v", "`<` needs numbers or text, got a vector"),
        ("${1 if n else 2}", "n", "`if` needs a boolean, got a number"),
        ("${v[2]}", "v[2]", "item 2 does not exist: the vector has 2"),
        ("${v[side]}", "side", "a vector has no row `left`"),
        ("${v[1.0]}", "1.0", "an index is a whole number, got `1.0`"),
        ("${v[left]}", "left", "an index is a whole number, got a boolean"),
        ("${t[0]}", "0", "the rows of a table have names, got a number"),
        ("${t.ankle}", "ankle", "the table has no row `ankle`; its rows are `hip`, `knee-1`"),
        ("${t.hip.kv}", "kv", "the row has no column `kv`; its columns are `kp`, `not`"),
        ("${t.hip.kp.x}", "x", "a number has no row `x`"),
        ("${t.hip.}", ".", "the expression ends without the name of a row"),
        ("${t.1}", ".1", "expected an operator, got `.1`"),
        ("x${t}", "t", "a table has no value here"),
        ("x${t.hip}", "t.hip", "a row has no value here"),
        ("${n[0]}", "n[0]", "a number has no items"),
        ("${speed}", "speed", "`speed` does not exist"),
        ("${True}", "True", "`True` does not exist"),
        ("${sin}", "sin", "`sin` is a function"),
        ("${sin()}", "sin()", "`sin` takes 1 numbers, got 0"),
        ("${a.b}", "a", "`a` does not exist"),
        ("${n && n}", "&&", "`&&` is not an operator"),
        ("${90degs}", "90degs", "`90degs` is not a number"),
        ("${(1 + 2}", "(", "`(` is never closed"),
        ("${1 2}", "2", "expected an operator, got `2`"),
        ("${1 +}", "+", "the expression ends without a value"),
        ("${}", "", "the expression is empty"),
        ("a ${1", "${1", "`${` is never closed"),
        ("${" + "(" * 80 + ")" * 80 + "}", "(", "the expression is nested too deep"),
        ("${" + "+".join("1" * 200) + "}", "+".join("1" * 200), "the expression is too long"),
        ("${" + "9" * 40 + "}", "9" * 40, "a number too large for an expression"),
    ],
)
def test_faults(text: str, part: str, message: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        value(text)
    assert caught.value.message == message
    assert text[slice(*caught.value.at)] == part


@pytest.mark.parametrize(
    "text",
    [
        "1" + " + 2" * 120,
        "'a'" + " + 'b'" * 120,
        "1" + " - 1 + 1" * 60,
        "1" + " ** 1" * 40,
        "(" * 40 + "1 + 1" + ") + 1" * 40,
    ],
)
def test_each_operand_is_evaluated_once(text: str) -> None:
    """A sum of 120 terms would take 2^120 evaluations if each term took two."""
    begun = time.process_time()
    value("${" + text + "}")
    assert time.process_time() - begun < 1


def test_a_sum_of_texts_is_bounded_before_it_is_made() -> None:
    half = "x" * 5000
    assert value("${'" + half + "' + '" + half + "' == side}") is False
    with pytest.raises(ExpressionError, match="text is at most 10000 characters long"):
        value("${'" + half + "' + '" + half + "x' == side}")


def test_more_expressions_in_one_text_than_anybody_writes() -> None:
    begun = time.process_time()
    with pytest.raises(ExpressionError, match="the text has 1000000 expressions; 10000 are allowed") as caught:
        value("x" + "${n}" * 1_000_000)
    assert caught.value.at[0] == 1 and caught.value.help is not None
    assert time.process_time() - begun < 1


def test_an_unknown_function_lists_what_exists() -> None:
    with pytest.raises(ExpressionError, match="the function `sine` does not exist; the functions are abs, min, max"):
        value("${sine(1)}")


_LEAVES = st.one_of(
    st.integers(0, 1000).map(str), st.floats(0, 1e6, allow_nan=False).map(repr), st.sampled_from(["n", "reach"])
)
_TREES = st.recursive(
    _LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+ - * / // %".split()), inner).map(lambda t: f"({t[0]} {t[1]} {t[2]})"),
        inner.map(lambda t: f"-{t}"),
        st.tuples(inner, inner).map(lambda t: f"max({t[0]}, {t[1]})"),
    ),
    max_leaves=12,
)


@given(_TREES)
def test_the_same_as_in_python(text: str) -> None:
    try:
        expected = eval(text, {"n": 3, "reach": 0.45, "max": max})  # of our own making
    except ZeroDivisionError:
        with pytest.raises(ExpressionError):
            value("${" + text + "}")
        return
    if not math.isfinite(expected) or abs(expected) >= 2**63:
        return
    try:
        assert value("${" + text + "}") == expected
    except ExpressionError as error:
        assert "too" in error.message or "finite" in error.message


@given(st.text("0123456789.+-*/%<>=!()[], abcdefnovr'\"${}", max_size=60))
def test_any_text_has_a_value_or_a_fault(text: str) -> None:
    try:
        value(text)
    except ExpressionError as error:
        assert 0 <= error.at[0] <= error.at[1] <= len(text)


@given(st.one_of(st.floats(allow_nan=False, allow_infinity=False), st.integers(-(10**15), 10**15)))
def test_numbers_keep_their_bits_in_text(number: float) -> None:
    assert float(shown(number)) == number


ANGLES: dict[str, Value] = {
    "t": Angle(10, "deg"),
    "r": Angle(1.0, "rad"),
    "v": (Angle(1, "deg"), Angle(2, "deg")),
    "k": 2,
    "zero": 0,
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-t", "-10deg"),
        ("+t", "10deg"),
        ("t + 5deg", "15deg"),
        ("t - t", "0deg"),
        ("t * 2", "20deg"),
        ("2 * t", "20deg"),
        ("t / 4", "2.5deg"),
        ("t % 3deg", "1deg"),
        ("v[1]", "2deg"),
        ("min(t, 5deg)", "5deg"),
        ("max(t, 0)", "10deg"),
        ("clamp(t, -5deg, 5deg)", "5deg"),
        ("abs(-t)", "10deg"),
        ("hypot(3deg, 4deg)", "5.0deg"),
        ("t if k > 1 else r", "10deg"),
        ("t + zero", "10deg"),
        ("atan2(t, t)", f"{math.pi / 4!r}rad"),
        ("asin(1)", f"{math.pi / 2!r}rad"),
        ("[v, k]", "[[1deg, 2deg], 2]"),
        ("t / 5deg", "2.0"),
        ("t // 3deg", "3"),
        ("deg(t)", "10"),
        ("rad(r)", "1.0"),
        ("deg(r)", repr(math.degrees(1))),
        ("sin(t)", repr(math.sin(math.radians(10)))),
        ("tan(k)", repr(math.tan(2))),
        ("rad(180) == pi", "true"),
        ("cos(180deg)", "-1.0"),
        ("t > 5deg", "true"),
        ("t < r", "true"),
        ("t == 10deg", "true"),
        ("180deg == 1rad * pi", "true"),
        ("t != r", "true"),
        ("0 < t <= 10deg", "true"),
        ("params.t", "10deg"),
    ],
)
def test_angles_stay_angles(text: str, expected: str) -> None:
    assert with_units(Template.parse(f"${{{text}}}").value(ANGLES)) == expected


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("t + 1", ["t + 1deg", "t + 1rad"]),
        ("-1.5 < t", ["-1.5deg < t", "-1.5rad < t"]),
        ("t > k", ["deg(t) > k", "rad(t) > k"]),
        ("max(t, k, r)", []),
        ("2 / t", ["2 / deg(t)", "2 / rad(t)"]),
        ("t * r", ["deg(t) * r", "rad(t) * r"]),
        ("(k + t) ** 2", ["(k + deg(t)) ** 2", "(k + rad(t)) ** 2"]),
        ("t ** 2", ["deg(t) ** 2", "rad(t) ** 2"]),
        ("round(t)", ["round(deg(t))", "round(rad(t))"]),
        ("sqrt(2 * t)", ["sqrt(deg(2 * t))", "sqrt(rad(2 * t))"]),
        ("t == 20", ["t == 20deg", "t == 20rad"]),
    ],
)
def test_an_angle_and_a_number_have_two_meanings(text: str, lines: list[str]) -> None:
    with pytest.raises(ExpressionError) as caught:
        Template.parse(f"${{{text}}}").value(ANGLES)
    assert (caught.value.help or "").split("`")[1::2] == lines
    for line in lines:
        assert Template.parse(f"${{{line}}}").value(ANGLES) is not None


@pytest.mark.parametrize(
    "text", ["t == 'a'", "t < v", "t + 'a'", "t and true", "1degs", "deg", "element.t", "params.x", "params"]
)
def test_angles_with_other_values(text: str) -> None:
    with pytest.raises(ExpressionError):
        Template.parse(f"${{{text}}}").value(ANGLES)


def test_an_angle_in_a_text_is_its_number() -> None:
    assert Template.parse("c${t}_${r}rad").value(ANGLES) == "c10_1.0rad"
    with pytest.raises(ExpressionError, match="followed by `rad`"):
        Template.parse("${t}rad").value(ANGLES)


@given(st.floats(-1e6, 1e6), st.floats(-1e3, 1e3), st.floats(0.125, 8))
def test_the_unit_of_a_parameter_does_not_matter(a: float, b: float, k: float) -> None:
    degrees: dict[str, Value] = {"a": Angle(a, "deg"), "b": Angle(b, "deg"), "k": k}
    radians: dict[str, Value] = {"a": Angle(math.radians(a), "rad"), "b": Angle(math.radians(b), "rad"), "k": k}
    for text in ("${k * a - b / k}", "${max(a, -b) + clamp(b, -1rad, 90deg)}", "${a if a > 10deg + b else -b}"):
        first = Template.parse(text).value(degrees)
        second = Template.parse(text).value(radians)
        assert isinstance(first, Angle) and isinstance(second, Angle)
        assert first.radians == pytest.approx(second.radians, rel=1e-9, abs=1e-9)


_TURN: dict[str, Value] = {
    "i": -2,
    "s": "le'ft",
    "w": (1, Angle(-2.5, "deg"), 3),
    "z": 0,
    "b": True,
    "a": Angle(0.1, "rad"),
    "m": DataTable({"kp": -20, "row": DataTable({"x": 0.1}), "name": "hip"}),
}
_PARAMETERS: dict[str, Value] = {
    "k": (4, -5, 6),
    "p": 0.3,
    "t": DataTable({"hip": DataTable({"x": 1}), "knee": DataTable({"x": 2})}),
}
_ELEMENT: dict[str, Value] = {"value": 1.5, "name": "hip", "index": 1, "size": (0.1, 0.2)}


def _expressions(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    return st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "//"]), inner).map(lambda each: f"({' '.join(each)})"),
        inner.map("-{}".format),
        inner.map("({})".format),
        inner.map("{} ** 2".format),
        st.tuples(inner, inner, inner, inner).map(lambda each: "({} if {} < {} else {})".format(*each)),
        st.tuples(inner, inner).map(lambda each: "max({}, {})".format(*each)),
        st.tuples(inner, inner, st.sampled_from(["0", "z", "index"])).map(lambda each: "[{}, {}][{}]".format(*each)),
        st.sampled_from(["z", "index", "1", "-1"]).map("(w)[{}]".format),
    )


_READ = [
    "i",
    "z",
    "a",
    "w[0]",
    "w[-2]",
    "value",
    "index",
    "m.kp",
    "p",
    "k[z]",
    "k[index]",
    "t[m.name].x",
    "t[name].x",
    "m.row.x",
    "size[z]",
    "(m)['kp']",
    "2",
    "30deg",
]


@given(st.lists(st.recursive(st.sampled_from(_READ), _expressions, max_leaves=8), min_size=1, max_size=2))
def test_a_turn_changes_no_value(expressions: list[str]) -> None:
    alone = len(expressions) == 1
    text = f"${{{expressions[0]}}}" if alone else "_${s}_".join(f"${{{each}}}" for each in expressions)

    def result(text: str, scope: dict[str, Value]) -> object:
        try:
            return with_units(Template.parse(text).value(scope))
        except ExpressionError:
            return "an error"

    whole = result(text, {**_PARAMETERS, **_TURN, **_ELEMENT})
    try:
        partial = bound(text, _TURN, _PARAMETERS)
    except ExpressionError:
        partial = "${1 / 0}"
    assert result(partial, {**_PARAMETERS, **_ELEMENT}) == whole


def test_what_a_turn_cannot_write() -> None:
    with pytest.raises(ExpressionError, match="a text with both kinds of quotes"):
        bound("${x + name}", {"x": "'\""}, {})
    with pytest.raises(ExpressionError, match="a table has no value here"):
        bound("${value + m}", {"m": DataTable({"a": 1})}, {})
