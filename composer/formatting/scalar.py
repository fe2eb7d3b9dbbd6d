"""Write a single value."""

from __future__ import annotations

import re

from composer.formatting.syntax import Leaf

INDENT = 2

_LINE_BREAK = re.compile(r"\r\n|\n|\r")
_HEADER = re.compile(r"([|>])([-+0-9]*)(.*)", re.DOTALL)


def lines_of(leaf: Leaf, indent: int) -> list[str]:
    r"""Return the lines of a value whose collection is at column `indent`; all but the first include their margin.

    Double quotes are used, and single quotes if they save escapes; unquoted text stays unquoted.

    >>> lines_of(Leaf("'a b'"), 0), lines_of(Leaf("'a\\b'"), 0), lines_of(Leaf("|\n     a\n      b", depth=5), 2)
    (['"a b"'], ["'a\\b'"], ['|', '    a', '     b'])
    """
    lines = _LINE_BREAK.split(leaf.text)
    if leaf.text[:1] in ("|", ">"):
        return _block(leaf, lines, indent)
    if len(lines) == 1:
        return [_quoted(leaf.text)]
    margin = " " * (indent + INDENT)
    inner = (f"{margin}{_cut(line.lstrip(' '))}" for line in lines[1:-1])
    return [
        _cut(lines[0]),
        *(line if line.strip(" ") else "" for line in inner),
        margin + lines[-1].lstrip(" "),
    ]


def _cut(line: str) -> str:
    """Strip spaces at the end of a line of folded text, which have no meaning unless the first one is escaped."""
    bare = line.rstrip(" ")
    return f"{bare} " if bare.endswith("\\") and bare != line else bare


def _quoted(text: str) -> str:
    if text[:1] != "'":
        return text
    content = text[1:-1].replace("''", "'")
    return text if '"' in content or "\\" in content else f'"{content}"'


def _block(leaf: Leaf, lines: list[str], indent: int) -> list[str]:
    found = _HEADER.fullmatch(lines[0])
    assert found is not None
    style, marks, rest = found.groups()
    # A last line without a line break has none in the value either, while the written file ends with one.
    chomping = "-" if not leaf.ended else "".join(set(marks) & set("-+"))
    depth = str(INDENT) if set(marks) - set("-+") else ""
    comment = f"  {rest.strip()}" if rest.strip() else ""
    content = [line[leaf.depth :] for line in lines[1:]]
    if chomping == "+" and content and not content[-1]:
        content.pop()  # the empty text after the last line break
    margin = " " * (indent + INDENT)
    return [f"{style}{depth}{chomping}{comment}", *(margin + line if line else "" for line in content)]
