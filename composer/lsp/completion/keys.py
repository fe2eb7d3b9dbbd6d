"""Completion of keys, sections and attributes, with their descriptions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from composer.lsp.answers import Item
from composer.lsp.language import Key, keys_of
from composer.lsp.question import Question

_COLLECTIONS = {"object", "array"}


def offer(question: Question) -> Iterator[Item]:
    """Yield the keys that the mapping at the cursor can still have. Required keys come first."""
    cursor = question.cursor
    if cursor.role not in ("key", "either"):
        return
    there = question.at(cursor.path)
    written = set(cursor.written) | (set(there) if isinstance(there, dict) else set())
    for at, key in enumerate(keys_of(question.forms)):
        if key.name in written and key.name != cursor.whole:
            continue
        rank = 10 if key.required else 20 + min(at, 20)
        yield Item(
            key.name, "key", _type(key), key.doc, rank, _insert(key, question), again=not _is_collection(key)
        )


def _insert(key: Key, question: Question) -> str:
    """Return the key with its colon. If its value is a mapping or list, an indented line follows."""
    cursor = question.cursor
    if cursor.has_colon:
        return key.name
    if not _is_collection(key) or cursor.in_flow:
        return f"{key.name}: "
    return f"{key.name}:\n{' ' * (cursor.start + 2)}"


def _is_collection(key: Key) -> bool:
    types = _types(key)
    return bool(types) and types <= _COLLECTIONS and "array" not in types


def _types(key: Key) -> set[str]:
    found: set[str] = set()
    for form in key.forms:
        said: Any = form.schema.get("type", ())
        found |= {said} if isinstance(said, str) else set(said)
        if "enum" in form.schema or "const" in form.schema:
            found.add("string")
    return found


def _type(key: Key) -> str:
    return "required" if key.required else ""
