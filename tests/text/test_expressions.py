from __future__ import annotations

import math
import time

import pytest
from hypothesis import given, strategies as st
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import Angle, ExpressionError, Value, shown, with_units

SCOPE: dict[str, Value] = {"reach": 0.45, "n": 3, "left": True, "side": "left", "v": (1, 2.5)}


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
        ("${v[n]}", "[n", "an index must be a whole number, as digits"),
        ("${n[0]}", "n[0]", "a number has no items"),
        ("${speed}", "speed", "`speed` does not exist"),
        ("${True}", "True", "`True` does not exist"),
        ("${sin}", "sin", "`sin` is a function"),
        ("${sin()}", "sin()", "`sin` takes 1 numbers, got 0"),
        ("${a.b}", ".", "expressions have no attributes"),
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
    "t": Angle(10, "deg"), "r": Angle(1.0, "rad"), "v": (Angle(1, "deg"), Angle(2, "deg")), "k": 2, "zero": 0,
}  # fmt: skip


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-t", "-10deg"), ("+t", "10deg"), ("t + 5deg", "15deg"), ("t - t", "0deg"), ("t * 2", "20deg"), ("2 * t", "20deg"),
        ("t / 4", "2.5deg"), ("t % 3deg", "1deg"), ("v[1]", "2deg"), ("min(t, 5deg)", "5deg"), ("max(t, 0)", "10deg"),
        ("clamp(t, -5deg, 5deg)", "5deg"), ("abs(-t)", "10deg"), ("hypot(3deg, 4deg)", "5.0deg"), ("t if k > 1 else r", "10deg"),
        ("t + zero", "10deg"), ("atan2(t, t)", f"{math.pi / 4!r}rad"), ("asin(1)", f"{math.pi / 2!r}rad"), ("[v, k]", "[[1deg, 2deg], 2]"),
        ("t / 5deg", "2.0"), ("t // 3deg", "3"), ("deg(t)", "10"), ("rad(r)", "1.0"), ("deg(r)", repr(math.degrees(1))),
        ("sin(t)", repr(math.sin(math.radians(10)))), ("tan(k)", repr(math.tan(2))), ("rad(180) == pi", "true"), ("cos(180deg)", "-1.0"),
        ("t > 5deg", "true"), ("t < r", "true"), ("t == 10deg", "true"), ("180deg == 1rad * pi", "true"), ("t != r", "true"),
        ("0 < t <= 10deg", "true"), ("params.t", "10deg"),
    ],
)  # fmt: skip
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
        first, second = Template.parse(text).value(degrees), Template.parse(text).value(radians)
        assert isinstance(first, Angle) and isinstance(second, Angle)
        assert first.radians == pytest.approx(second.radians, rel=1e-9, abs=1e-9)
