"""Skin files, whose bones have names: MuJoCo reads them alone and in a composition."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from random import Random

from fuzz.mutation import flipped
from fuzz.target import Seed, Target, Tools
from fuzz.targets.model import differs

_MODEL = """<mujoco><asset><skin name="s" file="{}"/></asset><worldbody><body name="a"><geom size=".1"/><body name="b" pos="1 0 0">
  <joint name="j"/><geom size=".1"/></body></body></worldbody></mujoco>"""


def _skin() -> bytes:
    vertices = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
    faces = struct.pack("<6i", 0, 1, 2, 0, 2, 3)
    bones = b"".join(
        name.ljust(40, b"\0")
        + struct.pack("<7f", 0, 0, 0, 1, 0, 0, 0)
        + struct.pack("<i", 4)
        + struct.pack("<4i", 0, 1, 2, 3)
        + struct.pack("<4f", 1, 1, 1, 1)
        for name in (b"a", b"b")
    )
    return struct.pack("<4i", 4, 0, 2, 2) + vertices + faces + bones


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    yield Seed(_skin())


def _mutate(data: bytes, random: Random, pool: Sequence[bytes]) -> bytes:
    """Numbers stay where numbers are, more often than not."""
    if random.random() < 0.4:
        return flipped(data, random)
    made = bytearray(data)
    for _ in range(random.randint(1, 3)):
        at = 4 * random.randrange(max(len(made) // 4, 1))
        number = random.choice((0, 1, 2, 5, -1, 2**31 - 1, 10**6, 0x7F800000, random.randrange(2**31)))
        made[at : at + 4] = struct.pack("<i", number)
    return bytes(made)


def check(path: Path, tools: Tools) -> str | None:
    model = path.with_name("model.xml")
    model.write_text(_MODEL.format(path.name), encoding="utf-8")
    recipes = {
        "base": "recipe: 1\nbase: ./model.xml\n",
        "part": "recipe: 1\nattach: {p: {model: ./model.xml, pos: [1, 0, 0]}}\n",
    }
    return differs(model, tools, recipes)


TARGET = Target("skin", ".skn", _seeds, _mutate, check)
