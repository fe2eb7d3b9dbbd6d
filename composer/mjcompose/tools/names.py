"""The names and addresses of a model, with units, ranges and keyframes, as JSON, Python or C++."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack
from itertools import chain, count
from typing import Any

from mjcompose.mujoco.engine import Session
from mjcompose.plan.read import Given
from mjcompose.sides.names import NamesRecord, names_of
from mjcompose.sides.operand import read_operand
from mjcompose.sides.side import load
from mjcompose.sources.context import Context

_KEPT = "names"
Address = tuple[str, int, str]
"""An identifier, the address and the name."""


def names(
    text: str, context: Context, given: Given | None = None, pick: str | None = None, sample: int | None = None
) -> NamesRecord | None:
    """Return the names of a recipe, a bundle or a model file; None after errors, which are reported."""
    with ExitStack() as opened, Session() as session:
        operand = read_operand(text, context, opened)
        if operand is None:
            return None
        side = load(operand, _KEPT, session, given=given, pick=pick, sample=sample, whole=True)
        operand.report(context.sink)
        return None if side is None or context.sink.has_errors else names_of(side, session, context)


def to_json(names: NamesRecord) -> str:
    return json.dumps(names.as_data(), indent=2, ensure_ascii=False) + "\n"


_KINDS = ("joints", "actuators", "sensors", "keyframes")
_TABLES = {
    "Qpos": ("joints", "qpos_", "`qpos`"),
    "Dof": ("joints", "dof_", "`qvel`"),
    "Ctrl": ("actuators", "ctrl_", "`ctrl`"),
    "Act": ("actuators", "act_", "`act`"),
    "Sensor": ("sensors", "", "`sensordata`"),
    "Key": ("keyframes", "", "order"),
}
"""Tables of addresses: the kind of elements, the beginning of their fields, and the vector."""


def _addresses(data: Mapping[str, Any], table: str, taken: frozenset[str], *, upper: bool) -> Iterator[Address]:
    kind, prefix, _ = _TABLES[table]
    used: set[str] = set()
    for number, row in enumerate(data[kind]):
        if row["name"] and row.get(f"{prefix}size", 1):
            word = _identifier(row["name"].upper() if upper else row["name"], taken)
            unique = next(each for each in chain([word], (f"{word}_{at}" for at in count(2))) if each not in used)
            used.add(unique)
            yield unique, row.get(f"{prefix}address", number), _printed(row["name"])


def _identifier(name: str, taken: frozenset[str]) -> str:
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "unnamed"
    word = f"n{word}" if word[0].isdigit() else word
    return f"{word}_" if word in taken else word


def _head(names: NamesRecord, data: Mapping[str, Any]) -> Iterator[str]:
    yield f"Names and addresses of the model {_printed(names.model)}, written by `mjcompose names`."
    yield "Angles are in radians, lengths in meters."
    yield f"sha256 of the MJCF text: {names.sha256}"
    for kind in _KINDS:
        number = sum(not row["name"] for row in data[kind])
        if number:
            yield f"{number} {kind if number > 1 else kind[:-1]} without a name: see `mjcompose names --json`."


def to_python(names: NamesRecord) -> str:
    """Return a module that imports only `enum`: an enumeration of addresses by vector, and a mapping by kind."""
    data = names.as_data()
    lines = [f"# {line}" for line in _head(names, data)]
    lines += ["", "from enum import IntEnum", "", f"MODEL = {names.model!r}", f"SHA256 = {names.sha256!r}"]
    lines += [f"{name.upper()} = {size}" for name, size in names.sizes.items()]
    for table, (_, _, vector) in _TABLES.items():
        lines += ["", "", f"class {table}(IntEnum):", f'    """Numbers in {vector}."""']
        found = [*_addresses(data, table, _PYTHON, upper=True)]
        lines += ["", *(f"    {word} = {number}  # {name}" for word, number, name in found)] if found else []
    for kind in _KINDS:
        lines += ["", "", f"{kind.upper()} = {{"]
        for row in data[kind]:
            if row["name"]:
                fields = (f"{key!r}: {_python(value)}" for key, value in row.items() if key != "name")
                lines.append(f"    {row['name']!r}: {{{', '.join(fields)}}},")
        lines.append("}")
    return "\n".join(lines) + "\n"


def _printed(name: str) -> str:
    return json.dumps(name)  # a backslash at the end of a comment would continue it


def _python(value: Any) -> str:
    if isinstance(value, list | tuple):
        items = [_python(each) for each in value]
        return f"({', '.join(items)}{',' * (len(items) == 1)})"
    return f'float("{value}")' if isinstance(value, float) and not math.isfinite(value) else repr(value)


_PYTHON = frozenset({"MRO"})
_CPP = frozenset(
    "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl"
    " concept const consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default"
    " delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long"
    " mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register"
    " reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch template"
    " this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t"
    " while xor xor_eq NULL EOF errno stdin stdout stderr assert linux unix INFINITY NAN std".split()
)
_TYPES = {"const char *": ", *", "int ": ", ", "Range ": ", ", "double ": ", "}
_STRUCTS = {
    "Joint": ("name type unit body", "qpos_address qpos_size dof_address dof_size", "range", ""),
    "Actuator": ("name unit", "ctrl_address ctrl_size act_address act_size", "act_range force_range", ""),
    "Sensor": ("name type unit", "address size", "", "cutoff"),
    "Keyframe": ("name", "", "", "time"),
}
"""The fields of each kind, by their types in C++."""
_ESCAPE = "\\%03o"
_WIDTHS = {"qpos": "nq", "qvel": "nv", "act": "na", "ctrl": "nu", "mpos": "3 * nmocap", "mquat": "4 * nmocap"}


def to_cpp(names: NamesRecord) -> str:
    """Return a C++17 header that includes only the standard library."""
    data = names.as_data()
    space = _identifier(names.model or "model", _CPP)
    lines = [f"// {line}" for line in _head(names, data)]
    lines += ["#pragma once", "", "#include <array>", "#include <limits>", "", f"namespace {space} {{", ""]
    lines += [f"inline constexpr char model[] = {_cpp(names.model)};"]
    lines += [f"inline constexpr char sha256[] = {_cpp(names.sha256)};"]
    lines += [f"inline constexpr int {name} = {size};" for name, size in names.sizes.items()]
    for table, (_, _, vector) in _TABLES.items():
        lines += ["", f"// Numbers in {vector}.", f"namespace {table.lower()} {{"]
        found = _addresses(data, table, _CPP, upper=False)
        lines += [*(f"inline constexpr int {word} = {number};  // {name}" for word, number, name in found), "}"]
    ranges = [[_cpp(each)[1:-1]] for row in data["actuators"] for each in row["ctrl_ranges"]]
    lines += ["", "struct Range {", "  bool limited;", "  double low, high;", "};"]
    lines += ["", "// In the order of `ctrl`.", *_array("Range", "ctrl_ranges", ranges)]
    for name, fields in _STRUCTS.items():
        vectors = _WIDTHS if name == "Keyframe" else {}
        types = zip(_TYPES.items(), fields, strict=True)
        members = [type + between.join(each.split()) for (type, between), each in types if each]
        members += [f"std::array<double, {width}> {vector}" for vector, width in vectors.items()]
        lines += ["", f"struct {name} {{", *(f"  {each};" for each in members), "};"]
        kind = f"{name.lower()}s"
        order = " ".join((*fields, *vectors)).split()
        lines += _array(name, kind, [[_cpp(row[key]) for key in order] for row in data[kind]])
    return "\n".join([*lines, "", f"}}  // namespace {space}"]) + "\n"


def _array(kind: str, name: str, rows: Sequence[Sequence[str]]) -> list[str]:
    start = f"inline constexpr std::array<{kind}, {len(rows)}> {name}"
    return [f"{start}{{{{", *(f"    {{{', '.join(row)}}}," for row in rows), "}};"] if rows else [f"{start}{{}};"]


def _cpp(value: object) -> str:
    """Return a value of C++. A pair of numbers or None is a range, and a list is the vector of a keyframe."""
    if value is None:
        return "{}"
    if isinstance(value, str):  # an escape of three octal digits ends by itself
        plain = {*range(32, 127)} - {*b'"\\?'}
        return f'"{"".join(chr(each) if each in plain else _ESCAPE % each for each in value.encode())}"'
    if isinstance(value, tuple):
        return f"{{true, {', '.join(map(_cpp, value))}}}"
    if isinstance(value, list):
        return f"{{{{{', '.join(map(_cpp, value))}}}}}" if value else "{}"
    if isinstance(value, float) and not math.isfinite(value):
        limit = "quiet_NaN" if math.isnan(value) else "infinity"
        return f"{'-' if value < 0 else ''}std::numeric_limits<double>::{limit}()"
    return repr(value)
