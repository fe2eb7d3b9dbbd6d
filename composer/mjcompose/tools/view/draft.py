"""The text of a recipe that a page changes: only the characters of the new values, and nothing else."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path
from typing import Any, TypeAlias

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path as Steps
from mjcompose.base.sink import Sink
from mjcompose.text.faults import quoted, word
from mjcompose.text.load import load
from mjcompose.text.node import (
    Change,
    Mapping,
    Node,
    Scalar,
    Sequence,
    added_key,
    changed,
    find,
    is_template,
    lines_of,
    resolve,
    to_python,
    with_item,
)

Written: TypeAlias = "str | dict[str, Written]"
"""The text of a value in YAML, or a mapping of them by the plain text of their keys."""
_MARK = b"\xef\xbb\xbf"


class Refused(Exception):
    """Why nothing is written; `more` is for the page."""

    def __init__(self, message: str, **more: Any) -> None:
        super().__init__(message)
        self.more = more


def value_of(text: str) -> Any:
    """Return the value of a text in YAML."""
    tree = load(f"value: {text}", "", sink := Sink())
    if sink.has_errors or not isinstance(tree, Mapping) or list(tree.entries) != ["value"]:
        raise Refused("this cannot be written as YAML")
    return to_python(tree.entries["value"][1])


def name_text(name: str) -> str:
    """Return a name as YAML that means the same name again."""
    text = word(name)
    text = text if isinstance(resolve(text), str) else quoted(name)
    if not name.isprintable() or not name or is_template(name) or value_of(text) != name:
        raise Refused("this name has characters that a recipe cannot have")
    return text


def short(value: float, digits: int) -> str:
    """Return a number with at most `digits` after the point.

    >>> short(0.30000000004, 5), short(-1e-9, 5)
    ('0.3', '0')
    """
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


@dataclass(slots=True)
class Draft:
    """A recipe, its tree, and the changes to be made. `wanted` is the meaning of its new text."""

    file: str
    path: Path
    raw: bytes
    text: str
    tree: Mapping
    wanted: Any
    changes: list[Change] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    @classmethod
    def of(cls, file: str, path: Path, raw: bytes) -> Draft:
        tree = load(raw, file, sink := Sink())
        if sink.has_errors or not isinstance(tree, Mapping):
            raise Refused(f"`{file}` is not a valid recipe now")
        return cls(file, path, raw, text=raw.decode("utf-8-sig"), tree=tree, wanted=to_python(tree))

    def set(self, path: Steps, value: Any, *changes: Change) -> None:
        """Note the changes by which the value at a path becomes another."""
        self.changes += changes
        holder = self.wanted
        for step in path[:-1]:
            holder = holder.setdefault(step, {}) if isinstance(step, str) else holder[step]
        holder[path[-1]] = value

    def rename(self, path: Steps, name: str) -> None:
        """Note another name for a key."""
        holder, node = self.wanted, find(self.tree, path[:-1])
        assert isinstance(node, Mapping)
        for step in path[:-1]:
            holder = holder[step]
        holder[name] = holder.pop(path[-1])
        self.changes.append(Change(node.entries[str(path[-1])][0].span, name))

    def write(self, path: Steps, value: Written) -> None:
        """Write a value, with the keys that are missing on the way. A mapping is written only where nothing is."""
        found = next(depth for depth in range(len(path), -1, -1) if find(self.tree, path[:depth]) is not None)
        holder = find(self.tree, path[:found])
        if found == len(path) and isinstance(holder, Scalar) and isinstance(value, str):
            self.set(path, value_of(value), Change(holder.span, value))
            return
        if not isinstance(holder, Mapping) or found == len(path):
            raise Refused(f"there is no place for `{path[-1]}` in `{self.file}`: write it yourself")
        self.set(path, _meaning(value))
        lines, row = lines_of(self.text), holder.span
        is_flow = found > 0 and (not holder.entries or lines[row.line - 1][row.column - 1 :][:1] == "{")
        indent = 0 if found == 0 or is_flow else next(iter(holder.entries.values()))[0].span.column - 1
        for step in reversed(path[found + 1 :]):
            value = {str(step): value}
        text = f"{name_text(str(path[found]))}:{_rendered(value, None if is_flow else indent + 2)}"
        self.changes.append(added_key(holder, lines, self.file, text=text, top=found == 0))

    def append(self, key: str, value: str) -> None:
        """Append an item to a list at the top of the recipe."""
        change = with_item(self.tree, lines_of(self.text), self.file, key=key, value=value)
        if change is None:
            raise Refused(f"`{key}` of `{self.file}` is not a list")
        self.wanted.setdefault(key, []).append(value_of(value))
        self.changes.append(change)

    def numbers(self, path: Steps, texts: list[str]) -> None:
        """Write a list of numbers; those that stay keep their text."""
        node = find(self.tree, path)
        if node is None:
            self.write(path, f"[{', '.join(texts)}]")
            return
        if not isinstance(node, Sequence) or not all(isinstance(each, Scalar) for each in node.items):
            raise Refused(f"`{path[-1]}` is not a list of numbers")
        changes, values = list[Change](), list[Any]()
        if len(node.items) == len(texts):
            for item, text in zip(node.items, texts, strict=True):
                assert isinstance(item, Scalar)
                value = value_of(text)
                values.append(item.value if _is_same(item.value, value) else value)
                changes += [] if _is_same(item.value, value) else [Change(item.span, text)]
        else:
            line = lines_of(self.text)[node.span.line - 1]
            if line[node.span.column - 1] != "[" or node.items[-1].span.end_line != node.span.line:
                raise Refused(f"`{path[-1]}` is written over several lines: write `[{', '.join(texts)}]` yourself")
            values, changes = [value_of(each) for each in texts], [Change(node.span, f"[{', '.join(texts)}]")]
        self.set(path, values, *changes)

    def result(self) -> bytes:
        """Return the new text. Refuses a text with another meaning."""
        end = "\r\n" if "\r\n" in self.text else "\n"
        text = changed(self.text, [Change(each.span, each.text.replace("\n", end)) for each in self.changes])
        tree: Node | None = load(text, self.file, sink := Sink())
        if sink.has_errors or tree is None or to_python(tree) != self.wanted:
            raise Refused(f"`{self.file}` cannot be changed here without changing something else: write it yourself")
        return (_MARK if self.raw.startswith(_MARK) else b"") + text.encode()


def _meaning(value: Written) -> Any:
    return value_of(value) if isinstance(value, str) else {name: _meaning(each) for name, each in value.items()}


def _rendered(value: Written, indent: int | None) -> str:
    """Return the text after the colon of a key: lines with an indent, or all in one line."""
    if isinstance(value, str):
        return f" {value}"
    entries = [(name_text(name), each) for name, each in value.items()]
    if indent is None or not entries:
        return f" {{{', '.join(f'{name}:{_rendered(each, None)}' for name, each in entries)}}}"
    return "".join(f"\n{' ' * indent}{name}:{_rendered(each, indent + 2)}" for name, each in entries)


def _is_same(before: Any, after: Any) -> bool:
    """Return whether a number need not be written again."""
    if isinstance(before, str) or isinstance(after, str) or isinstance(before, bool) or before is None:
        return bool(before == after)
    return bool(abs(before - after) < 5e-7)
