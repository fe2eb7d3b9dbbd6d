"""Every value of a file, each with the texts that may stand in its place to make it another one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from lxml import etree
from mjcompose.base.sink import Sink
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, Scalar, Sequence
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.parse import parse_file

# What changes nothing in the model, or says what is looked at and not what is there.
_NOT_OF_THE_MODEL = ("check", "matrix", "randomize", "variants", "recipe", "description")
_NAMES = ("name", "class", "childclass", "file")


@dataclass(frozen=True)
class Value:
    """One value: where it stands in its text, 1-based line, and what may stand there instead, the likeliest first."""

    file: Path
    path: str
    line: int
    start: int
    end: int
    others: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.file.name}:{self.line} {self.path}"

    def changed(self, other: str) -> str:
        """The text of the file with another value."""
        text = self.file.read_text()
        return text[: self.start] + other + text[self.end :]


def values_of(file: Path) -> list[Value]:
    """All values of a recipe or an MJCF file."""
    return list(_of_recipe(file) if file.suffix == ".yaml" else _of_mjcf(file))


def _of_recipe(file: Path) -> Iterator[Value]:
    text = file.read_text()
    starts = _starts(text)
    root = load(text.encode(), file.name, Sink())
    assert isinstance(root, Mapping)
    alike: dict[str, list[str]] = {}
    for path, scalar in _scalars(root, ()):
        alike.setdefault(_key(path), []).append(scalar.text)
    for path, scalar in _scalars(root, ()):
        span = scalar.span
        if path[0] in _NOT_OF_THE_MODEL or span.end_column is None or span.end_line != span.line:
            continue
        start = starts[span.line - 1] + span.column - 1
        end = starts[span.line - 1] + span.end_column - 1
        quote = text[start] if text[start] in "'\"" else ""
        others = tuple(f"{quote}{each}{quote}" for each in _others(_key(path), scalar.text, alike[_key(path)]))
        yield Value(file, ".".join(map(str, path)), span.line, start, end, others)


def _scalars(node: Node, path: tuple[str | int, ...]) -> Iterator[tuple[tuple[str | int, ...], Scalar]]:
    if isinstance(node, Scalar):
        yield path, node
    elif isinstance(node, Sequence):
        for index, item in enumerate(node.items):
            yield from _scalars(item, (*path, index))
    else:
        for name, (_, value) in node.entries.items():
            yield from _scalars(value, (*path, name))


def _key(path: tuple[str | int, ...]) -> str:
    return next((step for step in reversed(path) if isinstance(step, str)), "")


def _of_mjcf(file: Path) -> Iterator[Value]:
    text = file.read_text()
    starts = _starts(text)
    unit = parse_file(file, Sink())
    assert unit is not None
    alike: dict[str, list[str]] = {}
    for node in unit.root.iter("*"):
        for name, written in node.items():
            alike.setdefault(str(name), []).append(str(written))
    for node in unit.root.iter("*"):
        for name, written in node.items():
            if name == "model" or (name in _NAMES and node.tag != "geom"):
                continue
            span = unit.origins.span(node, unit.file, str(name))
            start = starts[span.line - 1] + span.column - 1
            if text[start : start + len(written)] != written:
                continue
            beside = [dict(each.items()) for each in _siblings(node)]
            others = tuple(
                other
                for other in _others(str(name), str(written), alike[str(name)], node)
                if {**dict(node.items()), name: other} not in beside  # of two that are equal either is right
            )
            path = f"{'/'.join(str(each.tag) for each in (*reversed(list(node.iterancestors())), node))}@{name}"
            yield Value(file, path, span.line, start, start + len(written), others)


def _siblings(node: etree._Element) -> list[etree._Element]:
    parent = node.getparent()
    return [] if parent is None else [each for each in parent.iterchildren(node.tag) if each is not node]


def _others(name: str, text: str, alike: list[str], node: etree._Element | None = None) -> Iterator[str]:
    if text in ("true", "false"):
        yield "false" if text == "true" else "true"
        return
    words = text.split()
    unit = next((each for each in ("deg", "rad", "M") if text.endswith(each)), "")
    numbers = [_number(word.removesuffix(unit)) for word in words]
    if numbers and None not in numbers:
        first = words[0].removesuffix(unit)
        for other in _other_numbers(first):
            yield " ".join([other + unit, *words[1:]])
        return
    if "${" in text:
        yield text.replace("${", "${1.07 * ")
        return
    seen = {text}
    for other in [*alike, *_words_of(name, node)]:
        if other not in seen:
            seen.add(other)
            yield other
    if name == "name":
        yield f"{text}_x"


def _other_numbers(text: str) -> Iterator[str]:
    value = float(text)
    if "." not in text and "e" not in text:
        yield from (str(int(value) + step) for step in (1, 2, -1))
    yield f"{value * 1.05 + 0.0003 * (value == 0):.9g}"
    yield f"{value * 0.95:.9g}"
    yield f"{value + 0.01:.9g}"


def _words_of(name: str, node: etree._Element | None) -> Iterator[str]:
    """The words that the grammar knows for an attribute."""
    for path in GRAMMAR.paths:
        attribute = GRAMMAR.element(path).attributes.get(name)
        if attribute is not None and attribute.keywords:
            yield from map(str, attribute.keywords)


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _starts(text: str) -> list[int]:
    """Where each line begins."""
    found = [0]
    for line in text.split("\n"):
        found.append(found[-1] + len(line) + 1)
    return found
