"""Expressions of xacro without Python behind them: what they give is what Python gives, and the rest is refused."""

from __future__ import annotations

import ast
import math
import time
from typing import Any

import pytest
from mjcompose.urdf import evaluating
from mjcompose.urdf.evaluating import DEEPEST, LONGEST, METHODS, Evaluator, Space, Stopped, XacroFunction

NAMES = {"x": 3, "half": 0.5, "name": "left_arm", "flags": [True, False], "size": {"a": 1, "b": [1.5, 2]}, "none": None}


def value(text: str, **names: Any) -> Any:
    tools = Evaluator()
    spaces = {"python": Space("python", tools.functions()), "math": Space("math", tools.mathematics())}
    return tools.value(text, ({**tools.functions(), **tools.mathematics(), **spaces, **NAMES} | names).__getitem__)


@pytest.mark.parametrize(
    "text",
    [
        "1 + 2 * 3 - 4 / 5 // 1 % 3 ** 2",
        "-x ** 2",
        "not x and name or flags",
        "x if half > 1 else name",
        "1 < x <= 3 != 4",
        "name[0] + name[-3:] + name[::2]",
        "size['b'][1]",
        "'left' in name and 'b' in size",
        "x not in flags",
        "[i * j for i in range(3) for j in flags if j]",
        "{k: v for k, v in size.items()}",
        "sum(i for i in [1, 2.5])",
        "name.split('_')[0].upper()",
        "'-'.join(sorted(['b', 'a'], key=len))",
        "list(map(float, '1 2.5'.split()))",
        "max(size['b']) - min(1, x)",
        "round(math.sin(math.radians(30)), 3)",
        "atan2(1, 2) + hypot(3, 4) + tau + factorial(5)",
        "int('ff', 16) + int(3.7) + abs(-2) + len(name)",
        "str(x) + str(half) + repr(name)",
        "'%03d %.2f %s' % (x, half, name)",
        "dict(c=1, **size)",
        "[*flags, *(1, 2)]",
        "isinstance(x, (int, str)) and not isinstance(name, python.float)",
        "size.get('c', 4) + size.get('a')",
        "(1).__class__ if False else 2",
        "name.replace('left', 'right').startswith(('r', 'l'))",
        "list(zip('ab', [1, 2])) + list(enumerate('c', 5))",
        "divmod(7, 2)",
        "1_000 + 0x10 + 0b11",
        "~5 | 3 & 6 ^ 1 << 4 >> 1",
        "all([]) is True and any(flags)",
        "half.is_integer()",
        "[[1] * 3] * 2",
        "none is None",
        "filter(None, [0, 1, 2])",
    ],
)
def test_it_is_what_python_makes_of_it(text: str) -> None:
    try:
        expected = eval(text, {**vars(math), "math": math, **NAMES, "python": Space("", {"float": float})})
    except (TypeError, AttributeError):
        expected = eval(text.replace("python.", ""), dict(NAMES))
    expected = list(expected) if isinstance(expected, filter) else expected
    assert repr(value(text)) == repr(expected)


@pytest.mark.parametrize(
    "text",
    [
        "().__class__",
        "(x for x in [1]).gi_frame",
        "'{0.__class__}'.format(1)",
        "python.str.mro()",
        "__import__('os')",
        "(lambda: 1)()",
        "dict(__x__=1)",
        "name.format_map(size)",
        "name.encode()",
        "math.update(size)",
        "math.root",
        "python.type(x)",
        "python.vars(math)",
        "flags.append(1)",
        "size.update(a=2)",
        "size.pop('a')",
        "x.real",
        "x.to_bytes(1)",
        "str(sin)",
        "[sin][0]('1').__doc__",
        "'%s' % (sin,)",
        "[i for i.a in flags]",
        "(y := 1)",
        "f'{x}'",
        "{1, 2}",
        "x @ x",
        "{**size}",
        "b'a'.decode()",
        "1j",
        "...",
        "(-8) ** 0.5",
        "sorted(flags, key=str.mro)",
        "size.__getitem__('a')",
        "[a for a in [1] if a.numerator]",
        "getattr(x, 'real')",
        "eval('1')",
        "exec('1')",
        "open('/etc/passwd')",
    ],
)
def test_what_is_not_listed_is_refused(text: str) -> None:
    with pytest.raises((Stopped, NameError, AttributeError, TypeError)):
        value(text)


LEADS_OUT = {
    *"gi_frame gi_code gi_yieldfrom cr_frame cr_code cr_await cr_origin ag_frame ag_code ag_await tb_frame tb_next".split(),
    *"f_back f_builtins f_code f_globals f_locals f_trace co_consts co_code format format_map mro".split(),
    *(each for kind in (str, list, dict, tuple, int, float, range, type(value), type(None)) for each in dir(kind)),
}


@pytest.mark.parametrize("name", sorted(LEADS_OUT))
def test_no_attribute_but_the_methods_that_are_listed(name: str) -> None:
    for text in ("'a'", "[1]", "dict(a=1)", "(1, 2)", "1", "0.5", "range(2)", "none", "sin", "math", "python", "flags"):
        kind = type(value(text))
        if name in METHODS.get(kind, ()) or (text, name) in {("math", "e"), ("python", "format")}:
            continue
        with pytest.raises((Stopped, NameError, AttributeError)):
            value(f"({text}).{name}")


@pytest.mark.parametrize(
    "text",
    [
        "'a' * 10**9",
        "10**9 * [0]",
        "9**9**9",
        "1 << 10**9",
        "(2**4000) ** 2",
        "list(range(10**9))",
        "range(10**12)",
        "'%1000000000d' % 1",
        "'%*d' % (10**9, 1)",
        "'x'.zfill(10**9)",
        "'x'.ljust(10**9)",
        "round(5, -10**9)",
        "math.factorial(10**6)",
        "math.comb(10**6, 5 * 10**5)",
        "math.perm(10**6)",
        "math.prod([2**4000] * 1000)",
        "[i for i in range(10**6) for j in range(10**6)]",
        "('a' * 10**5).replace('a', 'b' * 10**5)",
        "int('f' * 10**4, 16)",
        "('a' * 1000).join(['b'] * 10**5)",
        "'%s%s%s%s' % (('a' * 60000,) * 4)",
        "[[[[0] * 100] * 100] * 100] * 100",
        "str([[[0] * 100] * 100] * 200)",
        "sum(map(len, ['a' * 90000] * 90000))",
        "'a' in range(10**12)",
        "[[0] * 1000 for i in range(10**6)]",
        "[[0] * 1000] * 1000 == [[0] * 1000] * 1000 == 1",
    ],
)
def test_what_grows_is_stopped_before_it_does(text: str) -> None:
    begin = time.perf_counter()
    with pytest.raises((Stopped, OverflowError)):
        value(text)
    assert time.perf_counter() - begin < 2


def test_steps_are_counted_over_all_expressions_of_a_template() -> None:
    tools = Evaluator()
    tools.steps = 1000
    with pytest.raises(Stopped, match="steps"):
        for _ in range(1000):
            tools.value("1 + 1", {}.__getitem__)


@pytest.mark.parametrize(
    "text",
    [
        "-" * 5000 + "1",
        "[" * 150 + "]" * 150,
        "1" + " if 1 else 1" * 1500,
        "not " * 2000 + "1",
        "a" + ".a" * 3000,
        "1 ** " * 1500 + "1",
        "x" + "[0]" * 3000,
        "1" * (LONGEST + 1),
        "'" + "a" * LONGEST + "'",
        "\0",
        "\ud800",
    ],
    ids=range(11),
)
def test_what_cannot_be_looked_through_is_refused(text: str) -> None:
    with pytest.raises((Stopped, SyntaxError)):
        value(text)


def test_a_long_sum_is_not_deep() -> None:
    assert value("+".join(["1"] * (10 * DEEPEST))) == 10 * DEEPEST


@pytest.mark.parametrize("error", [RecursionError, MemoryError, ValueError, UnicodeError, OSError, SystemError])
def test_a_fault_while_parsing_refuses(monkeypatch: pytest.MonkeyPatch, error: type[Exception]) -> None:
    def fails(*_: Any) -> Any:
        raise error

    monkeypatch.setattr(ast, "parse", fails)
    with pytest.raises(Stopped):
        value("1 + 1")


@pytest.mark.parametrize("guard", ["weight", "spend", "admitted"])
@pytest.mark.parametrize("error", [RecursionError, MemoryError, OSError, UnicodeError])
def test_a_fault_in_a_guard_gives_no_value(monkeypatch: pytest.MonkeyPatch, guard: str, error: type[Exception]) -> None:
    def fails(*_: Any) -> Any:
        raise error

    monkeypatch.setattr(Evaluator, guard, fails)
    with pytest.raises(error):
        value("[1, 2] * 3")


def test_a_function_is_a_value_and_no_text() -> None:
    assert isinstance(value("sin"), XacroFunction)
    with pytest.raises(Stopped):
        str([value("sin")])


def test_names_of_comprehensions_end_with_them() -> None:
    assert value("[x for x in [7]] + [x]") == [7, 3]
    with pytest.raises(NameError) as fault:
        value("[y for y in [1]] + [y]")
    assert fault.value.name == "y"


def test_the_table_of_steps_has_no_way_to_run_code() -> None:
    assert not {ast.Lambda, ast.Await, ast.Yield, ast.NamedExpr, ast.JoinedStr} & evaluating._STEPS.keys()


@pytest.mark.parametrize("text", ["odd", "[odd]", "size['odd']", "[i for i in odds]", "str(odd)", "odds + [1]"])
def test_a_value_of_another_kind_does_not_come_in(text: str) -> None:
    odd = object()
    with pytest.raises(Stopped, match="kind"):
        value(text, odd=odd, size={"odd": odd}, odds=[odd])


@pytest.mark.parametrize("text", ["__x", "[__x for __x in [1]]", "dict(__x=1)", "dict(**size)"])
def test_names_with_two_underscores_are_nobodys(text: str) -> None:
    with pytest.raises(Stopped, match="__x"):
        value(text, __x=1, size={"__x": 1})


def test_a_method_of_a_mapping_is_no_key_of_it() -> None:
    with pytest.raises(Stopped):
        value("size.pop", size={"pop": 1})
