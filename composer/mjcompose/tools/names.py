"""The names and addresses of a model, with units, ranges and keyframes, as JSON, Python or C++."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.build.bundle.bundle import MODEL
from mjcompose.build.plan.read import Given
from mjcompose.mujoco import engine
from mjcompose.mujoco.arrays import BY_WORD
from mjcompose.mujoco.engine import Session
from mjcompose.mujoco.index import VECTORS, Index, addresses
from mjcompose.sources.context import Context
from mjcompose.tools.diff.sides import Side, load, read_operand

_KEPT = "names"


@dataclass(frozen=True, slots=True)
class Names:
    """The names of a model. `sha256` is the hash of its MJCF text, `keys` has the vectors of each keyframe."""

    model: str
    sha256: str
    sizes: Mapping[str, int]
    index: Index
    keys: Sequence[Mapping[str, Sequence[float]]]

    def as_data(self) -> dict[str, Any]:
        """Return everything in the order of the model; elements without a name have an empty one."""
        rows = asdict(self.index)
        keys = [{**row, **key} for row, key in zip(rows["keyframes"], self.keys, strict=True)]
        for row in rows["joints"]:
            row["unit"] = BY_WORD[row["type"]].unit  # None for a free joint, which has several
        for row in rows["actuators"]:
            del row["stiffness"]
        kinds = {name: rows[name] for name in ("joints", "actuators", "sensors")}
        return {"model": self.model, "sha256": self.sha256, "sizes": dict(self.sizes), **kinds, "keyframes": keys}


def names(
    text: str, context: Context, given: Given | None = None, pick: str | None = None, sample: int | None = None
) -> Names | None:
    """Return the names of a recipe, a bundle or a model file; None after errors, which are reported."""
    with ExitStack() as opened, Session() as session:
        operand = read_operand(text, context, opened)
        if operand is None:
            return None
        side = load(operand, _KEPT, session, given=given, pick=pick, sample=sample, whole=True)
        operand.report(context.sink)
        return None if side is None or context.sink.has_errors else names_of(side, session, context)


def names_of(side: Side, session: Session, context: Context) -> Names | None:
    """Return the names of a model that the session keeps, or None if MuJoCo crashes, which is reported."""
    answer = engine.call(session, addresses, [side.kept], argument=None)
    if not answer.ok:
        message = f"the names of `{side.operand.label}` cannot be read: {answer.error or answer.crash}"
        context.sink.error("mujoco-crash", message)
        return None
    model = "" if side.traced is None else str(side.traced.model.root.get("model") or "")
    file = side.bundle.model if side.bundle is not None else MODEL
    value = answer.value
    return Names(model, side.digests[file], value["sizes"], index=Index.from_data(value["index"]), keys=value["keys"])


def to_json(names: Names) -> str:
    return json.dumps(names.as_data(), indent=2, ensure_ascii=False) + "\n"


_HEAD = ("Names and addresses of the model {}, written by `mjcompose names`.",
         "Angles are in radians, lengths in meters.", "sha256 of the MJCF text: {}")  # fmt: skip
# Names of the tables of addresses, and the addresses with the element's name in each.
_Rows = Callable[[Index], Iterable[tuple[str, int]]]
_TABLES: Mapping[str, tuple[str, _Rows]] = {
    "Qpos": ("addresses in `qpos`", lambda index: ((each.name, each.qpos_address) for each in index.joints)),
    "Dof": ("addresses in `qvel`", lambda index: ((each.name, each.dof_address) for each in index.joints)),
    "Ctrl": ("addresses in `ctrl`", lambda index: ((e.name, e.ctrl_address) for e in index.actuators if e.ctrl_size)),
    "Act": ("addresses in `act`", lambda index: ((e.name, e.act_address) for e in index.actuators if e.act_size)),
    "Sensor": ("addresses in `sensordata`", lambda index: ((e.name, e.address) for e in index.sensors if e.size)),
    "Key": ("numbers of keyframes", lambda index: ((each.name, number) for number, each in enumerate(index.keyframes))),
}


def _identifiers(
    rows: Iterable[tuple[str, int]], taken: frozenset[str], *, upper: bool
) -> Iterator[tuple[str, int, str]]:
    """Yield an identifier, the number and the name of each element that has a name."""
    used: set[str] = set()
    for name, number in rows:
        word = re.sub(r"[^A-Za-z0-9]+", "_", name.upper() if upper else name).strip("_") or "unnamed"
        word = f"n{word}" if word[0].isdigit() else word
        word = f"{word}_" if word in taken else word
        unique, count = word, 2
        while unique in used:
            unique, count = f"{word}_{count}", count + 1
        used.add(unique)
        if name:
            yield unique, number, name


def _nameless(index: Index) -> Iterator[str]:
    for kind in ("joints", "actuators", "sensors", "keyframes"):
        count = sum(not each.name for each in getattr(index, kind))
        if count:
            yield f"{count} {kind if count > 1 else kind[:-1]} without a name: see `mjcompose names --json`."


def to_python(names: Names) -> str:
    """Return a module that imports only `enum`: an enumeration of addresses by vector, and a mapping by kind."""
    head = [line.format(value) for line, value in zip(_HEAD, (_printed(names.model), "", names.sha256), strict=True)]
    lines = [f"# {line}" for line in (*head, *_nameless(names.index))]
    lines += ["", "from enum import IntEnum", "", f"MODEL = {names.model!r}", f"SHA256 = {names.sha256!r}"]
    lines += [f"{name.upper()} = {size}" for name, size in names.sizes.items()]
    for title, (about, rows) in _TABLES.items():
        found = list(_identifiers(rows(names.index), frozenset({"MRO"}), upper=True))
        lines += ["", "", f"class {title}(IntEnum):", f'    """{about.capitalize()}."""']
        lines += ["", *(f"    {word} = {number}  # {_printed(name)}" for word, number, name in found)] if found else []
    data = names.as_data()
    for kind in ("joints", "actuators", "sensors", "keyframes"):
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


_CPP = frozenset(
    "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl"
    " concept const consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default"
    " delete do double dynamic_cast else enum explicit export extern false float for friend goto if inline int long"
    " mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register"
    " reinterpret_cast requires return short signed sizeof static static_assert static_cast struct switch template"
    " this thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t"
    " while xor xor_eq NULL EOF errno stdin stdout stderr assert linux unix INFINITY NAN".split()
)
_STRUCTS = {
    "Range": ("bool limited", "double low, high"),
    "Joint": (
        "const char* name, *type, *unit, *body", "int qpos_address, qpos_size, dof_address, dof_size", "Range range",
    ),
    "Actuator": (
        "const char* name, *unit", "int ctrl_address, ctrl_size, act_address, act_size", "Range act_range, force_range",
    ),
    "Sensor": ("const char* name, *type, *unit", "int address, size", "double cutoff"),
    "Keyframe": (
        "const char* name", "double time", "std::array<double, nq> qpos", "std::array<double, nv> qvel",
        "std::array<double, na> act", "std::array<double, nu> ctrl", "std::array<double, 3 * nmocap> mpos",
        "std::array<double, 4 * nmocap> mquat",
    ),
}  # fmt: skip


def to_cpp(names: Names) -> str:
    """Return a C++17 header that includes only the standard library."""
    index = names.index
    space = next(_identifiers([(names.model or "model", 0)], _CPP | {"std"}, upper=False))[0]
    head = [line.format(value) for line, value in zip(_HEAD, (_printed(names.model), "", names.sha256), strict=True)]
    lines = [f"// {line}" for line in (*head, *_nameless(index))]
    lines += ["#pragma once", "", "#include <array>", "#include <limits>", "", f"namespace {space} {{", ""]
    lines += [f"inline constexpr char model[] = {_text(names.model)};"]
    lines += [f"inline constexpr char sha256[] = {_text(names.sha256)};"]
    lines += [f"inline constexpr int {name} = {size};" for name, size in names.sizes.items()]
    for title, (about, rows) in _TABLES.items():
        lines += ["", f"// {about.capitalize()}.", f"namespace {title.lower()} {{"]
        found = _identifiers(rows(index), _CPP, upper=False)
        lines += [f"inline constexpr int {word} = {number};  // {_printed(name)}" for word, number, name in found]
        lines.append("}")
    for name, members in _STRUCTS.items():
        lines += ["", f"struct {name} {{", *(f"  {each};" for each in members), "};"]
    lines += _array("Joint", "joints", (
        [*map(_text, (each.name, each.type, BY_WORD[each.type].unit, each.body)), each.qpos_address, each.qpos_size,
         each.dof_address, each.dof_size, _range(each.range if each.limited else None)]
        for each in index.joints))  # fmt: skip
    lines += _array("Actuator", "actuators", (
        [_text(each.name), _text(each.unit), each.ctrl_address, each.ctrl_size, each.act_address, each.act_size,
         _range(each.act_range), _range(each.force_range)] for each in index.actuators))  # fmt: skip
    ranges = [[_range(each)[1:-1]] for actuator in index.actuators for each in actuator.ctrl_ranges]
    lines += ["", "// In the order of `ctrl`.", *_array("Range", "ctrl_ranges", ranges)[1:]]
    lines += _array("Sensor", "sensors", (
        [*map(_text, (each.name, each.type, each.unit)), each.address, each.size, _number(each.cutoff or 0.0)]
        for each in index.sensors))  # fmt: skip
    lines += _array("Keyframe", "keyframes", (
        [_text(each.name), _number(each.time), *(_numbers(key[vector]) for vector in VECTORS)]
        for each, key in zip(index.keyframes, names.keys, strict=True)))  # fmt: skip
    return "\n".join([*lines, "", f"}}  // namespace {space}"]) + "\n"


def _array(kind: str, name: str, rows: Iterable[Sequence[object]]) -> list[str]:
    found = [f"    {{{', '.join(map(str, row))}}}," for row in rows]
    start = f"inline constexpr std::array<{kind}, {len(found)}> {name}"
    return ["", f"{start}{{{{", *found, "}};"] if found else ["", f"{start}{{}};"]


def _text(text: str | None) -> str:
    """Return a text of C++; escapes with three octal digits end by themselves."""
    if text is None:
        return "nullptr"
    letters = (chr(byte) if 32 <= byte < 127 and byte not in b'"\\?' else f"\\{byte:03o}" for byte in text.encode())
    return f'"{"".join(letters)}"'


def _number(value: float) -> str:
    if math.isfinite(value):
        return repr(float(value))
    limit = "quiet_NaN" if math.isnan(value) else "infinity"
    return f"{'-' if value < 0 else ''}std::numeric_limits<double>::{limit}()"


def _numbers(values: Sequence[float]) -> str:
    return f"{{{{{', '.join(map(_number, values))}}}}}" if values else "{}"


def _range(pair: tuple[float, float] | None) -> str:
    return "{false, 0.0, 0.0}" if pair is None else f"{{true, {_number(pair[0])}, {_number(pair[1])}}}"
