"""Commands on inputs that double: the exponent of the processor time, beside that of MuJoCo's own compile.

An exponent of 1 is linear. It draws the plot `growth_commands.svg` in `docs/pictures`. `tests/growth` counts calls
on small inputs of every command; this measures seconds on large ones.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path

import mujoco

from bench.growth import _PICTURES, _once, _processor, _python
from bench.plot import plot
from bench.row import Row

_SIZES = (500, 1_000, 2_000, 4_000)
_EXPONENT = 1.5
_PART = """<mujoco model="part"><worldbody><body name="link"><joint name="j" axis="0 0 1"/>
<geom name="g" type="box" size="0.02 0.02 0.02" contype="0" conaffinity="0"/></body></worldbody></mujoco>"""

Words = list[str]


def rows() -> Iterator[Row]:
    Path("part.xml").write_text(_PART)
    start = _processor(lambda: _python("-m", "mjcompose", "version"))
    took: dict[str, Mapping[int, float]] = {}
    compiled = {size: _once(lambda size=size: _compile(size)) for size in _SIZES}  # type: ignore[misc]
    for name, write in _CASES.items():
        took[name] = {size: _seconds(write, size) - start for size in _SIZES}
    note = " ".join(f"{size:,}: {seconds:.2f} s" for size, seconds in compiled.items())
    yield Row("exponent of MuJoCo's compile of N bodies", _exponent(compiled), None, note)
    for name, seconds in took.items():
        note = " ".join(f"{size:,}: {value:.2f} s" for size, value in seconds.items())
        yield Row(f"exponent of `{name}`", _exponent(seconds), _EXPONENT, note)
    first = next(iter(took))
    series = {f"mjcompose {first}": took[first], "MuJoCo: compile": compiled}
    title = "A scene of bodies without joints: processor time"
    (_PICTURES / "growth_commands.svg").write_text(plot(title, "bodies", "s", series))


def _exponent(seconds: Mapping[int, float]) -> float:
    """Return the exponent of the last doubling."""
    (small, few), (large, many) = list(seconds.items())[-2:]
    return math.log(many / few) / math.log(large / small)


def _seconds(write: Callable[[int], Words], size: int) -> float:
    words = write(size)
    return _processor(lambda: _python("-m", "mjcompose", *words))


def _bodies(count: int) -> str:
    bodies = "\n".join(
        f'<body name="b{number}" pos="{number % 50 * 0.1} {number // 50 * 0.1} 0">'
        f'<geom name="g{number}" size="0.02" contype="0" conaffinity="0"/></body>'
        for number in range(count)
    )
    # MuJoCo 4.0 needs 4 bytes of its stack for each pair of bodies: 32 MB for 4,000, and has 15 MB.
    memory = '<size memory="300M"/>'
    return f'<mujoco model="scene">{memory}<worldbody>\n{bodies}\n</worldbody></mujoco>\n'


def _compile(count: int) -> None:
    mujoco.MjModel.from_xml_string(_bodies(count))


def _recipe(lines: Iterable[str], start: str = "recipe: 1\nbase: ./base.xml\n") -> None:
    Path("scene.yaml").write_text(start + "".join(f"{line}\n" for line in lines))


def _lint(count: int) -> Words:
    Path("base.xml").write_text(_bodies(count))
    return ["lint", "base.xml", "-q", "--ignore", "no-license"]


def _edits(count: int) -> Words:
    Path("base.xml").write_text(_bodies(count))
    _recipe(["edit:", *(f"  - {{select: {{geom: g{number}}}, set: {{group: 3}}}}" for number in range(count))])
    return ["build", "scene.yaml", "--no-cache", "--no-compile", "-q", "-o", "scene.xml"]


def _parts(count: int) -> None:
    parts = (f"  p{number}: {{model: ./part.xml, pos: [{number}, 0, 0]}}" for number in range(count))
    _recipe(["attach:", *parts], start="recipe: 1\n")


def _explain(count: int) -> Words:
    _parts(count)
    return ["explain", "scene.yaml", "p1/j"]


def _fmt(count: int) -> Words:
    Path("base.xml").write_text(_bodies(1))
    _recipe(
        ["edit:", *(f"  - {{set: {{group: {number % 6}}},\n     select: {{geom: g0}}}}" for number in range(count))]
    )
    return ["fmt", "scene.yaml"]


_CASES: Mapping[str, Callable[[int], Words]] = {
    "lint of N bodies without joints": _lint,
    "build with N edits, --no-compile": _edits,
    "explain one joint of N parts": _explain,
    "fmt of N entries in another order": _fmt,
}
