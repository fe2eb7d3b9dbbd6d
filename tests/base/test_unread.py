"""Facts travel as fields: no module looks into the message of a diagnostic or of an error to learn something."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import mjcompose
import pytest

ROOT = Path(mjcompose.__file__).parent
LOOKING = frozenset(
    {"partition", "rpartition", "startswith", "endswith", "removeprefix", "removesuffix", "find", "index", "count"}
    | {"rfind", "rindex", "rsplit", "replace", "search", "match", "fullmatch", "findall"}
)


def readings(text: str) -> Iterator[str]:
    """Where a message is looked into: by a method of text, by a pattern, or for a word in it."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in LOOKING:
            looked_at = [node.func.value, *node.args]
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "split":
            looked_at = [node.func.value] if node.args else []
        elif isinstance(node, ast.Compare) and any(isinstance(each, ast.In | ast.NotIn) for each in node.ops):
            looked_at = [node.comparators[0]]
        else:
            continue
        if any(isinstance(each, ast.Attribute) and each.attr == "message" for each in looked_at):
            yield f"line {node.lineno}: {ast.unparse(node)}"


def test_no_message_is_looked_into() -> None:
    found = {
        f"{path.relative_to(ROOT)} {reading}"
        for path in ROOT.rglob("*.py")
        for reading in readings(path.read_text(encoding="utf-8"))
    }
    assert not found


@pytest.mark.parametrize(
    "text",
    [
        "a.message.rpartition(': ')",
        "'mass' in a.message",
        "_PATTERN.search(a.message)",
        "a.message.split('`')",
        "f'`{name}`' in fault.message",
        "error.message.replace(path, shown)",
    ],
)
def test_what_is_looking_into_one(text: str) -> None:
    assert list(readings(text))


@pytest.mark.parametrize("text", ["' '.join(a.message.split())", "print(a.message)", "a.messages.find(1)"])
def test_what_is_not(text: str) -> None:
    assert not list(readings(text))
