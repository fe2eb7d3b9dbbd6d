"""Quote text, and find the end of text that lacks its quotes."""

from __future__ import annotations

import re

_OPENING = {"[": "]", "{": "}", "(": ")"}

_PLAIN = re.compile(r"[A-Za-z_./][\w./ -]*\w|\w|[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def word(text: str) -> str:
    """Return text as YAML, quoted if it would otherwise be something else.

    Text that looks like a number stays unquoted.
    """
    if _PLAIN.fullmatch(text) and text.lower() not in ("true", "false", "null"):
        return text
    return quoted(text)


def quoted(text: str) -> str:
    """Return text as a YAML string, in the quotes that need no escapes.

    >>> print(quoted("**/x"), quoted('${a == "b"}'))
    "**/x" '${a == "b"}'
    """
    if '"' in text or "\\" in text:
        return "'" + text.replace("'", "''") + "'"
    return f'"{text}"'


def unquoted_end(text: str, start: int, flow: bool) -> int:
    """Return where the text from `start` was probably meant to end, at the latest at the end of its line.

    Brackets are skipped to their partner. `flow` says that the text is in `[ ]` or `{ }`.

    >>> line = "{a: -${x[0]} * 2, b: 1}"
    >>> line[4:unquoted_end(line, 4, True)]
    '-${x[0]} * 2'
    """
    closing: list[str] = []
    quote = ""
    index = start
    while index < len(text) and text[index] not in "\r\n":
        character = text[index]
        if quote:
            quote = "" if character == quote else quote
        elif closing and character in "\"'":
            quote = character
        elif character in _OPENING:
            closing.append(_OPENING[character])
        elif closing and character == closing[-1]:
            closing.pop()
        elif not closing:
            if flow and character in ",]}":
                break
            if character == ":" and text[index + 1 : index + 2] in ("", " ", "\n", "\r"):
                break
            if character == "#" and text[index - 1 : index] in (" ", "\t"):
                break
        index += 1
    return start + len(text[start:index].rstrip())


def unquoted_start(text: str, index: int) -> int:
    """Return where the text around `index`, which is in `[ ]` or `{ }`, was probably meant to begin."""
    start = index
    while start > 0 and text[start - 1] not in ",[{\r\n" and text[start - 2 : start] not in (": ", "- "):
        start -= 1
    while start < index and text[start] in " \t":
        start += 1
    return start


def in_flow(text: str, index: int, outer: bool) -> bool:
    """Return whether `index` is in `[ ]` or `{ }`; `outer` says whether the start of its line is."""
    depth, quote = int(outer), ""
    begin = max(text.rfind("\n", 0, index), text.rfind("\r", 0, index)) + 1
    for character in text[begin:index]:
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character in "[{":
            depth += 1
        elif character in "]}":
            depth -= 1
    return depth > 0
