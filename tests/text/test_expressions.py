from __future__ import annotations

import math
import time

import pytest
from hypothesis import given, strategies as st
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError, Value, shown

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
