"""Expressions: each has a value or an error, soon."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

from fuzz.mutation import flipped
from fuzz.target import Seed, Target, Tools
from mjcompose.text.evaluate import evaluate
from mjcompose.text.expression import DataTable, ExpressionError, Value, parse

_SEEDS = (
    "1 + 2 * 3",
    "-x / 2 ** 0.5",
    "a if b and not c else v[0]",
    "clamp(x, 0, 1) + sin(deg(pi))",
    "9 ** 9 ** 9",
    "max(1, 2, x) // 3 % 4",
    "v == [1, 2, 3]",
    "name + 'a' * 3",
    "hypot(v[0], v[1]) <= 1e3",
    "round(x, 2)",
    "((((1))))",
    "t.hip.kp * v[-1]",
    "t[name].range[0]",
    "(t)['hip'].kp if t.hip.on else t['a b']",
)
_TOKENS = (
    *"+-*/%()[],.<>=!",
    "**",
    "//",
    "<=",
    "==",
    "!=",
    "and",
    "or",
    "not",
    "if",
    "else",
    "x",
    "v",
    "b",
    "name",
    "pi",
    "abs(",
    "min(",
    "sqrt(",
    "rad(",
    "v[",
    "t.",
    "t[",
    ".kp",
    "hip",
    "1e308",
    "1e-320",
    "0x1",
    "9" * 400,
    "'a'",
    '"',
    "90deg",
    "true",
    "None",
    "__class__",
)
_ROW = DataTable({"kp": 20, "range": (-1, 1), "on": True})
_SCOPE: dict[str, Value] = {
    "x": 0.5,
    "a": 3,
    "b": True,
    "c": False,
    "v": (1, 2.0, 3),
    "name": "arm",
    "t": DataTable({"hip": _ROW, "arm": _ROW, "a b": 1}),
}


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    yield from (Seed(each.encode()) for each in _SEEDS)


def _mutate(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    if random.random() < 0.2:
        return flipped(data, random)
    words = re.findall(r"\w+|\W", data.decode("utf-8", "replace"))
    for _ in range(random.randint(1, 6)):
        at = random.randrange(len(words) + 1)
        words[at : at + random.randint(0, 2)] = [random.choice(_TOKENS)] * random.choice((1, 1, 1, 60))
    return "".join(words)[:20_000].encode()


def check(path: Path, tools: Tools) -> str | None:
    try:
        evaluate(parse(path.read_bytes().decode("utf-8", "replace")), _SCOPE)
    except ExpressionError:
        return None
    return None


TARGET = Target("expression", ".txt", _seeds, _mutate, check)
