"""Expressions of templates for xacro, made by a grammar: each has the value that Python gives it, or is refused, soon."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random
from typing import Any

from fuzz.mutation import flipped
from fuzz.target import Seed, Target, Tools
from mjcompose.urdf.evaluating import METHODS, Evaluator, Space, Stopped

_NAMES: dict[str, Any] = {
    "x": 0.5,
    "n": 7,
    "flag": True,
    "name": "left_arm_2",
    "words": ["a", "b", ""],
    "size": {"a": 1, "b": [1, 2.5, {"c": "d"}]},
    "pair": (1, "two"),
    "none": None,
}
_ATOMS = (
    *_NAMES,
    "1",
    "0",
    "-2",
    "3.25",
    "1e300",
    "1_0",
    "''",
    "'ab c'",
    '"%s-%03d"',
    "[]",
    "()",
    "[1, 2]",
    "pi",
    "math",
    "python",
    "True",
    "None",
    "'%' * 3",
    "10 ** 9",
    "range(4)",
    "sin",
    "str",
    "b'x'",
    "...",
    "1j",
    "__import__",
    "nothing",
)
_BINARY = (
    *"+-*/%@&|^<>",
    "**",
    "//",
    "<<",
    ">>",
    "==",
    "!=",
    "<=",
    ">=",
    " and ",
    " or ",
    " in ",
    " not in ",
    " is ",
    " if 1 else ",
)
_FUNCTIONS = (
    *"len str float int bool round abs all any divmod ord repr sum range dict list tuple enumerate reversed zip map filter".split(),
    *"sorted min max isinstance sin sqrt radians factorial comb prod hypot math.atan2 python.type python.str eval open".split(),
)
_ATTRIBUTES = (
    *sorted({each for methods in METHODS.values() for each in methods}),
    "a",
    "b",
    "pi",
    "format",
    "__class__",
    "mro",
    "append",
    "update",
    "gi_frame",
    "f_globals",
    "root",
    "real",
)
_AROUND = (
    "-{}",
    "not {}",
    "({})",
    "[{}]",
    "{}[0]",
    "[{}][0]",
    "str({})",
    "({},)",
    "[i for i in {}]",
    "{} if 1 else 2",
    "1 if {} else 2",
    "{}.a",
    "{}()",
    "~{}",
    "max({}, 1)",
    "1 + {}",
    "{} ** 1",
    "1 ** {}",
    "lambda: {}",
    "{} or 1",
    "{} < 1",
    "'a' * {}",
    "{} * 2",
    "dict(a={})",
    "{}.upper()",
    "[*{}]",
    "({} for i in words)",
    "[[0] * 9] * {}",
)
_EVENTS: list[str] = []
_AT_WORK = [False]


def _made(random: Random, depth: int) -> str:
    """An expression by the grammar, mostly of what is listed."""
    if depth <= 0 or random.random() < 0.15:
        return random.choice(_ATOMS)

    def inner() -> str:
        return _made(random, depth - random.randint(1, 3))

    match random.randrange(11):
        case 0 | 1 | 2:
            return f"{inner()}{random.choice(_BINARY)}{inner()}"
        case 3:
            return f"{random.choice(_FUNCTIONS)}({', '.join(inner() for _ in range(random.randint(0, 3)))})"
        case 4:
            given = ", ".join(inner() for _ in range(random.randint(0, 2)))
            return f"({inner()}).{random.choice(_ATTRIBUTES)}({given})"
        case 5:
            return f"({inner()}).{random.choice(_ATTRIBUTES)}"
        case 6:
            index = random.choice(("{}", "{}:", ":{}", "::{}", "{}:{}")).replace("{}", inner())
            return f"({inner()})[{index}]"
        case 7:
            return f"[{', '.join(inner() for _ in range(random.randint(0, 4)))}]"
        case 8:
            opening, ending = random.choice(("[]", "()", ("dict(", ")"), ("sorted(", ")"), ("list(", ")")))
            condition = random.choice(("", f" if {inner()}", f" for j in {inner()}"))
            return f"{opening}{random.choice(('i', inner()))} for i in {inner()}{condition}{ending}"
        case 9:
            return f"{inner()} if {inner()} else {inner()}"
        case _:
            return random.choice(_AROUND).replace("{}", f"({inner()})")


def _mutate(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    roll = random.random()
    if roll < 0.1:
        return flipped(data, random)
    text = _made(random, random.randint(1, 14))
    if roll < 0.4:  # deep
        around = random.choice(_AROUND)
        for _ in range(random.choice((3, 30, 90, 99, 100, 101, 200, 1000, 3000))):
            text = around.replace("{}", text)
            if len(text) > 30_000:
                break
    return text[:40_000].encode()


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    yield Seed(b"size['b'][2].c + str(round(radians(n) * x, 3))")
    yield from (Seed(around.replace("{}", "n").encode()) for around in _AROUND)


def _heard(event: str, arguments: tuple[Any, ...]) -> None:
    if _AT_WORK[0] and event not in ("compile", "object.__getattr__"):
        _EVENTS.append(event)


def _of_python() -> dict[str, Any]:
    """What the names stand for in Python; what makes iterators there makes lists here."""
    eager = {
        each.__name__: (lambda *given, make=each: list(make(*given)))
        for each in (map, filter, zip, enumerate, reversed)
    }
    plain = (
        len,
        str,
        float,
        int,
        bool,
        round,
        abs,
        all,
        any,
        divmod,
        ord,
        repr,
        sum,
        range,
        dict,
        list,
        tuple,
        sorted,
        min,
        max,
        isinstance,
    )
    names = {each.__name__: each for each in plain} | eager
    mathematics = {name: each for name, each in vars(math).items() if not name.startswith("_")}
    spaces = {"math": math, "python": type("python", (), dict(names))}
    return {**mathematics, **names, **spaces, **_NAMES, "__builtins__": {}}


_REFUSES = (NameError, TypeError, ValueError, LookupError, ArithmeticError, AttributeError, SyntaxError, Stopped)


def check(path: Path, tools: Tools) -> str | None:
    if not _EVENTS and not any(each is _heard for each in _HOOKED):
        sys.addaudithook(_heard)
        _HOOKED.append(_heard)
    text = path.read_bytes().decode("utf-8", "surrogateescape")
    evaluator = Evaluator()
    spaces = {"math": Space("math", evaluator.mathematics()), "python": Space("python", evaluator.functions())}
    names = {**evaluator.mathematics(), **evaluator.functions(), **spaces, **_NAMES}
    before = repr(_NAMES)
    _EVENTS.clear()
    _AT_WORK[0] = True
    try:
        value = evaluator.value(text, names.__getitem__)
        said = repr(value)
    except _REFUSES:
        return None
    finally:
        _AT_WORK[0] = False
        if _EVENTS:
            return f"reaches-{_EVENTS[0]}"  # noqa: B012  whatever else happened
        if repr(_NAMES) != before:
            return "changes-a-value"  # noqa: B012
    expected = repr(eval(text.strip(), _of_python()))  # what was let through is what is listed
    return None if said == expected else f"differs: {said[:200]} and not {expected[:200]}"


_HOOKED: list[Any] = []
TARGET = Target("xacro", ".txt", _seeds, _mutate, check)
