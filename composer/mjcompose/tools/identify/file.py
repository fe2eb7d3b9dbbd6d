"""The text of a file of measurements."""

from __future__ import annotations

import datetime
import json
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from mjcompose.language.measured import FORMAT, TOPICS, ZERO

_ANGLES = (ZERO, "springref", "ref")
"""Numbers that are angles of a hinge, which have their unit."""


def text_of(name: str, recipe: Path, fit: Mapping[str, Any], mujoco: str, hinges: set[str]) -> str:
    """Return the text of the file for a fit; `hinges` are the names of joints whose zero is an angle."""
    return "\n".join(_lines(name, recipe, fit, mujoco, hinges)) + "\n"


def _lines(name: str, recipe: Path, fit: Mapping[str, Any], mujoco: str, hinges: set[str]) -> Iterator[str]:
    hashes = "".join(f', {topic}: "{fit["topics"][topic]}"' for topic in TOPICS)
    yield f"measured: {FORMAT}                 # the version of this format"
    yield f"name: {_text(name)}"
    yield f"date: {datetime.date.today()}"
    yield f"recipe: {{file: {_text(recipe.name)}{hashes}}}"
    yield f'mujoco: "{mujoco}"'
    yield "recordings:"
    for used, key in (("fit", "recordings"), ("held out", "held_out")):
        for each in fit[key]:
            about = f"seconds: {each['seconds']:.3f}, samples: {each['samples']}, used: {used}"
            yield f'- {{file: {_text(each["file"])}, sha256: "{each["sha256"]}", {about}}}'
    yield "errors:                     # root mean square of recording minus model, in rad, m, rad/s, m/s"
    for error in fit["errors"]:
        yield f"  {_text(error['signal'])}: {{{_errors(error)}}}"
    yield "values:"
    owner = None
    for number in fit["numbers"]:
        if owner != (owner := f"{number['kind']} {number['names'][0]}"):
            yield f"  {_text(owner)}:"
        yield f"    {number['attribute']}: {{{', '.join(_number(number, hinges))}}}"
    if len(fit["numbers"]) > 1:
        yield "correlation:                # rows below the diagonal, in the order of `values`, in percent"
        for index, row in enumerate(fit["correlation"][1:], 1):
            yield f"- [{', '.join(str(round(100 * each)) for each in row[:index])}]"


def _errors(error: Mapping[str, Any]) -> str:
    held = error["held_out"]
    out = f", held out: {{recipe: {held['recipe']:.3g}, fitted: {held['fitted']:.3g}}}" if held else ""
    return f"recipe: {error['recipe']:.3g}, fitted: {error['fitted']:.3g}{out}, correlated: {error['correlated']:.3g}"


def _number(number: Mapping[str, Any], hinges: set[str]) -> Iterator[str]:
    unit = "rad" if number["attribute"] in _ANGLES and number["names"][0] in hinges else ""
    std = number["std"]
    low, high = number["range"]
    value = min(max(rounded(number["value"], std), low), high)
    yield f"value: {value!r}{unit}"
    yield f"std: {rounded(std)!r}{unit}"
    yield f"recipe: {rounded(number['recipe'])!r}{unit}"
    yield f"range: [{low!r}{unit}, {high!r}{unit}]"
    if len(number["names"]) > 1:
        yield f"also: [{', '.join(_text(name) for name in number['names'][1:])}]"
    if number["verdict"]:
        yield f"{number['verdict']}: {json.dumps(number['reason'], ensure_ascii=False)}"


def rounded(value: float, std: float | None = None) -> float:
    """Return a number with as many digits as its standard deviation supports, plus two; or else with four.

    >>> rounded(0.61662345, 0.066), rounded(1.95362, 0.00066), rounded(0.0661234)
    (0.6166, 1.95362, 0.06612)
    """
    digits = 4
    if std and math.isfinite(std) and value:
        supported = math.floor(math.log10(abs(value))) - math.floor(math.log10(std)) + 3
        digits = max(2, min(9, supported))
    return float(f"{value:.{digits}g}")


_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_/.+-]*(?: [A-Za-z0-9_/.+-]+)*")
_WORDS = frozenset({"null", "true", "false"})


def _text(text: str) -> str:
    """Return a text as YAML, with quotes if it needs them.

    >>> _text("joint arm/elbow"), _text("12"), _text("a: b")
    ('joint arm/elbow', '"12"', '"a: b"')
    """
    is_plain = _PLAIN.fullmatch(text) and text.lower() not in _WORDS
    return text if is_plain else json.dumps(text, ensure_ascii=False)
