"""Data of Python as YAML: a recipe from a program, and the values that a program gives."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from numbers import Real
from os import PathLike, fsdecode
from pathlib import PurePath
from typing import Any, TypeAlias

from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.limits import LimitAdvice, advice, in_force
from mjcompose.base.report import MjcomposeError, short_traceback
from mjcompose.text.faults import MAX_KEY
from mjcompose.text.key_order import Collection, Document, Leaf, TextEntry, put_in_order
from mjcompose.text.layout import INDENT, write
from mjcompose.text.load import is_text_in_yaml_1_1
from mjcompose.text.node import resolve

Data: TypeAlias = "bool | int | float | str | list[Data] | dict[str, Data] | None"
"""A value of YAML in Python's own types."""
DataPath: TypeAlias = tuple[str | int, ...]
"""The keys and the indices that lead to a value."""

WIDTH = 110
"""The number of characters in a line beyond which a value takes several lines."""


@short_traceback
def dumps(recipe: Mapping[str, Any], /) -> str:
    """Return a recipe as YAML, in the layout of `mjcompose fmt`.

    Numbers and arrays of numpy, tuples and paths become numbers, lists and text. Raises TypeError for other values,
    with their place in the mapping, such as `recipe['attach']['arm']`.

    >>> print(dumps({"recipe": 1, "add": [{"to": "world", "site": {"name": "tip", "pos": (0, 0, 1e-3)}}]}), end="")
    recipe: 1
    add:
      - {to: world, site: {name: tip, pos: [0, 0, 0.001]}}
    """
    return to_yaml(plain_recipe(recipe))


def plain_recipe(recipe: Mapping[str, Any]) -> dict[str, Data]:
    """Return a recipe in Python's own types. Raises TypeError, and MjcomposeError if it exceeds a limit."""
    if not isinstance(recipe, Mapping):
        raise TypeError(f"a recipe is a mapping, got `{type(recipe).__name__}`")
    return _Conversion("recipe").mapping(recipe, ())


def plain(value: Any, name: str) -> Data:
    """Return a value in Python's own types; `name` is its name in messages. Raises as `plain_recipe` does."""
    return _Conversion(name).value(value, ())


def place(name: str, path: DataPath) -> str:
    """Return the place of a value as Python writes it.

    >>> place("recipe", ("edit", 0, "set"))
    "recipe['edit'][0]['set']"
    """
    return name + "".join(f"[{step!r}]" for step in path)


_TIMES = frozenset("mM")
"""The kinds of numpy whose values may become numbers without a unit."""
_MOST_STEPS = 8
"""The number of steps of a place that a message about a limit shows."""


class _Conversion:
    """Converts one value, within the limits of YAML files. `name` is the value's name in messages."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._count = 0
        self._holders: set[int] = set()
        self._most = in_force().yaml_values
        self._deepest = in_force().yaml_depth

    def value(self, value: Any, path: DataPath) -> Data:
        self._check_count(1)
        if value is None or isinstance(value, bool):
            return value
        if isinstance(value, str):
            return self._text(value, path)
        if isinstance(value, int | float):
            return self._number(value, path)
        if isinstance(value, PathLike):
            return self._text(value.as_posix() if isinstance(value, PurePath) else fsdecode(value), path)
        if isinstance(value, Mapping):
            return self.mapping(value, path)
        if isinstance(value, bytes | bytearray | memoryview):
            raise self._refusal(value, path)
        if hasattr(value, "tolist") and hasattr(value, "shape"):  # a number or an array of numpy, JAX or PyTorch
            return self._array(value, path)
        if isinstance(value, Sequence):
            return self._list(value, path)
        raise self._refusal(value, path)

    def _array(self, array: Any, path: DataPath) -> Data:
        self._check_count(math.prod(array.shape))
        dtype = getattr(array, "dtype", None)
        if getattr(dtype, "kind", "") in _TIMES or getattr(dtype, "names", None):
            raise self._refusal(array, path)
        mask = getattr(array, "mask", None)
        if mask is not None and mask.any():
            raise TypeError(f"{place(self._name, path)} has masked values; a recipe has no such values")
        value = array.tolist()
        if type(value) is not type(array):
            return self.value(value, path)
        if isinstance(value, Real):  # Python has no number for numpy's `longdouble`
            return self._number(float(value), path)
        raise self._refusal(value, path)

    def mapping(self, mapping: Mapping[Any, Any], path: DataPath) -> dict[str, Data]:
        self._enter(mapping, path)
        result: dict[str, Data] = {}
        for key, value in mapping.items():
            name = self._key(key, path)
            result[name] = self.value(value, (*path, name))
        self._holders.remove(id(mapping))
        return result

    def _list(self, items: Sequence[Any], path: DataPath) -> list[Data]:
        self._enter(items, path)
        result = [self.value(item, (*path, index)) for index, item in enumerate(items)]
        self._holders.remove(id(items))
        return result

    def _enter(self, collection: object, path: DataPath) -> None:
        if id(collection) in self._holders:
            raise TypeError(f"{place(self._name, path)} contains itself")
        if len(path) >= self._deepest:
            shown = f"{place(self._name, path[:_MOST_STEPS])}{'…' * (len(path) > _MOST_STEPS)}"
            message = f"{shown} has more than {self._deepest} lists and mappings within each other"
            raise _limit_error("yaml-too-deep", message, advice("yaml-depth"))
        self._holders.add(id(collection))

    def _check_count(self, more: int) -> None:
        self._count += more
        if self._count > self._most:
            message = f"more than {self._most} values in `{self._name}`"
            raise _limit_error("yaml-too-large", message, advice("yaml-values"))

    def _key(self, key: object, path: DataPath) -> str:
        if not isinstance(key, str):
            raise TypeError(f"a key of {place(self._name, path)} must be text, got {key!r}")
        if len(key) > MAX_KEY:
            raise TypeError(f"a key of {place(self._name, path)} has more than {MAX_KEY} characters")
        return self._text(key, (*path, key))

    def _text(self, text: str, path: DataPath) -> str:
        own = str.__str__(text)  # of an enumeration, its value
        if any("\ud800" <= character <= "\udfff" for character in own):
            raise TypeError(f"{place(self._name, path)} has half of a surrogate pair, which is not a character")
        return own

    def _number(self, number: int | float, path: DataPath) -> int | float:
        if isinstance(number, int):
            whole = int(number)
            try:
                float(whole)
            except OverflowError:
                raise TypeError(f"{place(self._name, path)} is a number that is too large") from None
            return whole
        if math.isnan(number):
            raise TypeError(f"{place(self._name, path)} is {number!r}, which is not a number")
        return float(number)

    def _refusal(self, value: object, path: DataPath) -> TypeError:
        return TypeError(f"{place(self._name, path)} is of type `{type(value).__name__}`; a recipe has no such values")


def _limit_error(code: str, message: str, help: LimitAdvice) -> MjcomposeError:
    return MjcomposeError([Diagnostic(code, message, help=help)])


def to_yaml(recipe: dict[str, Data]) -> str:
    """Return a mapping as a YAML file, in the canonical layout. No I/O."""
    entries = [_entry(key, value, 0) for key, value in recipe.items()]
    root = Collection(mapping=True, flow=not entries, entries=entries)
    put_in_order(root)
    lines = write(Document([], [], parted=False, head=None, root=root, tail=[]))
    return "\n".join([*lines, ""])


def in_brackets(value: Data) -> str:
    """Return a value as YAML on one line. No I/O.

    >>> in_brackets({"pos": [0, 1e-5, float("inf")], "name": "no", "when": "${a}"})
    '{pos: [0, 1e-05, .inf], name: "no", when: "${a}"}'
    """
    if isinstance(value, dict):
        return f"{{{', '.join(f'{_text(key)}: {in_brackets(inner)}' for key, inner in value.items())}}}"
    if isinstance(value, list):
        return f"[{', '.join(map(in_brackets, value))}]"
    return _scalar(value)


def _entry(key: str | None, value: Data, indent: int) -> TextEntry:
    """Return an entry of a block whose lines begin at column `indent`; `key` is None in a list."""
    start = "- " if key is None else f"{_text(key)}: "
    flow = not (indent == 0 and _is_nested(value)) and _room_after(value, WIDTH - indent - len(start)) >= 0
    return TextEntry(0, _key(key), _node(value, flow=flow, indent=indent + INDENT))


def _is_nested(value: Data) -> bool:
    """Return whether a value of a section has inner collections, which people write on lines of their own."""
    return isinstance(value, dict | list) and any(isinstance(inner, dict | list) for _, inner in _entries(value))


def _key(key: str | None) -> Leaf | None:
    return None if key is None else Leaf(_text(key))


def _entries(value: dict[str, Data] | list[Data]) -> Iterator[tuple[str | None, Data]]:
    """Yield the keys and values of a mapping, or the items of a list with None."""
    if isinstance(value, dict):
        yield from value.items()
    else:
        for item in value:
            yield None, item


def _node(value: Data, flow: bool, indent: int) -> Leaf | Collection:
    if isinstance(value, str) and not flow and _is_block(value):
        return _block(value)
    if not isinstance(value, dict | list):
        return Leaf(_scalar(value))
    if not flow and value:
        entries = [_entry(key, inner, indent) for key, inner in _entries(value)]
    else:
        entries = [TextEntry(0, _key(key), _node(inner, flow=True, indent=indent)) for key, inner in _entries(value)]
    return Collection(isinstance(value, dict), flow=flow or not value, entries=entries)


def _room_after(value: Data, room: int) -> int:
    """Return the rest of `room` after a value on one line. If it is negative, the value does not fit."""
    if isinstance(value, str) and _is_block(value):
        return -1
    if not isinstance(value, dict | list):
        return room - len(_scalar(value))
    room -= len("[]")
    for number, (key, inner) in enumerate(_entries(value)):
        start = ", " * (number > 0) + ("" if key is None else f"{_text(key)}: ")
        room = _room_after(inner, room - len(start))
        if room < 0:
            break
    return room


def _is_block(text: str) -> bool:
    """Return whether a text is written as lines below `|`: one of several lines, in which each character is visible."""
    if "\n" not in text:
        return False
    lines = text.removesuffix("\n").split("\n")
    begins = lines[0][:1] not in ("", " ", "\t")  # else YAML needs the depth of its indentation
    return begins and lines[-1] != "" and all(line == "" or _is_visible(line) for line in lines)


def _is_visible(line: str) -> bool:
    return not line.isspace() and line.replace("\t", " ").isprintable()


def _block(text: str) -> Leaf:
    header = "|" if text.endswith("\n") else "|-"
    return Leaf(f"{header}\n" + text.removesuffix("\n"), ended=text.endswith("\n"))


def _scalar(value: Data) -> str:
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, float) and math.isinf(value):
        return ".inf" if value > 0 else "-.inf"
    return json.dumps(value)


_MARKUP = re.compile(r"""[{}\[\],&*#?|<>=!%@`"'\\\t\n]|^[-:]|^\.\.\.|:$|: |^ | $""")
"""Characters that may have a meaning in YAML at their place. Some of these texts would need no quotes."""
_UNPRINTABLE = re.compile(r"[^\x20-\x7e\xa1-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")


def _text(text: str) -> str:
    """Return a text as YAML, in double quotes only if it could be read as something else."""
    is_plain = (
        text != ""
        and text.isprintable()
        and _MARKUP.search(text) is None
        and _is_text(text)
        and is_text_in_yaml_1_1(text)
    )
    return text if is_plain else _UNPRINTABLE.sub(_escape, json.dumps(text, ensure_ascii=False))


def _is_text(text: str) -> bool:
    try:
        return isinstance(resolve(text), str)
    except OverflowError:  # a number that is too large
        return False


def _escape(found: re.Match[str]) -> str:
    code = ord(found[0])
    return f"\\u{code:04x}" if code <= 0xFFFF else f"\\U{code:08x}"
