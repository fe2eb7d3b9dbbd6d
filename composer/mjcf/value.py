"""Convert values of attributes from Python and numpy to MJCF text and back. References are handled elsewhere."""

from __future__ import annotations

import math
import os
import re
from typing import Any

import numpy as np

from composer.grammar.attribute import Attribute
from composer.grammar.characters import NOT_XML
from composer.grammar.check import check_length, check_python, check_value, expected, plain
from composer.grammar.format import number_text, to_text
from composer.grammar.number import INT_MAX, items, parse_real
from composer.grammar.refusal import Refusal
from composer.tree.classes import ORIENTATIONS

# Types of which text may be given as it stands in XML; of numbers too.
_WRITTEN = ("bool", "keyword", "keywords", "references")
# Where infinity has no meaning but makes every later number NaN; a range or a limit may be infinite.
_FINITE = frozenset(
    {"pos", "axis", "fromto", "size", "mass", "density", "diaginertia", "fullinertia", *ORIENTATIONS}
    | {"scale", "vertex", "timestep", "gravity", "qpos", "qvel", "mpos", "mquat", "ref"}
)
# One number or several as almost everybody writes them.
_DECIMALS = re.compile(
    r"[ \t\n\r]*(?:[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?:[ \t\n\r]+|$))+", re.ASCII
)
_BOOLEANS = {True: "true", False: "false"}


class BadValue(ValueError):
    """A value is not accepted; the message continues the attribute's name."""

    def __init__(self, refusal: Refusal | str) -> None:
        super().__init__(refusal)
        self.refusal = Refusal(refusal) if isinstance(refusal, str) else refusal


def encode(attribute: Attribute, value: object) -> str:
    """Return the MJCF text of a value. A value that is text must be valid MJCF. Raises `BadValue`.

    Numbers are written so that they read back to the same bits. If the attribute has no fixed length, an array of
    more than one dimension is written row by row.
    """
    quick = plain_text(attribute, value)
    if quick is not None:
        return quick
    if isinstance(value, os.PathLike) and attribute.type == "file":
        value = os.fspath(value)
    if isinstance(value, str):
        written = attribute.is_number or attribute.type in _WRITTEN
        fault = check_value(attribute, value) if written else check_python(attribute, value)
        text = value
    else:
        value = _flat(attribute, value)
        fault = check_python(attribute, value)
        text = "" if fault else to_text(attribute, value)
    if fault is not None:
        raise BadValue(fault)
    if attribute.is_number:
        _check_finite(attribute, text)
    unwritable = NOT_XML.search(text)
    if unwritable:
        raise BadValue(f"has the character {unwritable.group()!r}, which XML cannot hold")
    return text


def decode(attribute: Attribute, text: str) -> object:
    """Return the Python value of an attribute's text. Raises `BadValue` for text that MuJoCo would refuse.

    One number is returned as a numpy scalar, several as an array of `float64` or `int64` with the shape `(n,)`. A
    keyword is returned as text, a list of keywords as a list, and a boolean as a `bool`.
    """
    if attribute.type == "real" and _DECIMALS.fullmatch(text):
        decimals = list(map(float, text.split()))
        if check_length(attribute, len(decimals)) is None and not any(map(math.isinf, decimals)):
            return np.float64(decimals[0]) if attribute.max_length == 1 else np.array(decimals)
    fault = check_value(attribute, text)
    if fault is not None:
        raise BadValue(fault)
    if attribute.type == "bool":
        return text == "true"
    if attribute.type == "keywords":
        return items(text)
    if not attribute.is_number:
        return text
    numbers = [parse_real(item) for item in items(text)]
    array = np.array(numbers, dtype=np.int64 if attribute.type == "int" else np.float64)
    return array[0] if attribute.max_length == 1 else array


def plain_text(attribute: Attribute, value: object) -> str | None:
    """Return the text of a value that is clearly valid, such as finite numbers, or None if it needs a full check."""
    if attribute.type == "keyword":
        return value if type(value) is str and value in attribute.keywords else None
    if attribute.type == "bool":
        return _BOOLEANS[value] if type(value) is bool else None
    if not attribute.is_number:
        return None
    numbers: Any = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    if type(numbers) is float or type(numbers) is int:
        numbers = (numbers,)
    elif (type(numbers) is not list and type(numbers) is not tuple) or attribute.max_length == 1:
        return None
    if check_length(attribute, len(numbers)) is not None:
        return None
    texts = []
    for number in numbers:
        if type(number) is int and -INT_MAX <= number <= INT_MAX:
            texts.append(str(number))
        elif type(number) is float and attribute.type == "real" and math.isfinite(number):
            texts.append(number_text(number))
        else:
            return None
    return " ".join(texts)


def _check_finite(attribute: Attribute, text: str) -> None:
    for item in items(text):
        number = parse_real(item) or 0.0
        if math.isnan(number):
            raise BadValue("expects numbers, got `nan`")
        if math.isinf(number) and attribute.name in _FINITE:
            raise BadValue(f"expects finite numbers, got `{item}`")


def _flat(attribute: Attribute, value: object) -> object:
    """Return arrays and tuples as lists. If the attribute takes any number of items, join the rows."""
    open_ended = attribute.is_number and attribute.max_length is None
    shape = getattr(value, "shape", None)
    if shape is not None and len(shape) > 1 and attribute.is_number:
        if not open_ended:
            raise BadValue(f"expects a flat array, got one of shape {tuple(shape)}")
        value = np.asarray(value).reshape(-1)
    if isinstance(value, bytes | bytearray):
        raise BadValue(f"expects {expected(attribute)}, got `{value!r}`")
    if isinstance(value, np.ndarray | np.generic) and value.dtype.kind == "f":
        value = value.astype(np.float64)  # a `longdouble` is not a `float`
    value = plain(value)
    if not isinstance(value, list | tuple):
        return value
    flat = [plain(item) for item in value]
    if open_ended and flat and all(isinstance(item, list | tuple) for item in flat):
        if len({len(row) for row in flat if isinstance(row, list | tuple)}) > 1:
            raise BadValue("expects rows of one length, got several")
        return [plain(number) for row in flat if isinstance(row, list | tuple) for number in row]
    return flat
