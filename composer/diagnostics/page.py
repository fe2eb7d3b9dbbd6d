"""The documentation page of a code: what the fault is, an example, how to fix it."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

from composer.diagnostics.codes import CODES
from composer.diagnostics.paint import Paint

_PASTED = re.compile(r"(?:(?:error|warning|note)?\[)?([\w-]+)\]?:?")
_LINK = re.compile(r"\[([^]]+)\]\((?!\))[^)]*\)")
_CODE = re.compile(r"`([^`]+)`")
_ITEM = re.compile(r"(?:[-*]|\d+\.) ")


def code_of(text: str) -> str | None:
    """Return the code in a text, also in the form that messages show; None if there is no such code.

    >>> code_of("error[bare-angle]:"), code_of("bare-angle"), code_of("arm.yaml")
    ('bare-angle', 'bare-angle', None)
    """
    found = _PASTED.fullmatch(text)
    return found[1] if found and found[1] in CODES else None


def page(code: str) -> str:
    """Return the page as Markdown: the copy beside this file in an installed package, `docs/errors` in a clone."""
    here = Path(__file__).resolve()
    name = f"{code}.md"
    installed = here.with_name("pages") / name
    path = installed if os.path.exists(installed) else here.parents[2] / "docs" / "errors" / name
    return path.read_text(encoding="utf-8")


def address(code: str, urls: Iterable[str] | None = None) -> str | None:
    """Return the address of the page on the published site; None if the package names no site.

    `urls` are addresses in the form of a package's metadata, by default those of this package, which `pyproject.toml`
    has under `[project.urls]`.

    >>> address("bare-angle", ["Documentation, https://example.org/latest/"])
    'https://example.org/latest/errors/bare-angle.html'
    >>> address("bare-angle", [])
    """
    for each in _urls() if urls is None else urls:
        label, _, url = each.partition(", ")
        if label.lower() == "documentation":
            return f"{url.rstrip('/')}/errors/{code}.html"
    return None


@cache
def _urls() -> tuple[str, ...]:
    from importlib import metadata  # takes longer to import than a page takes to print

    try:
        return tuple(metadata.metadata("mjcompose").get_all("Project-URL") or ())
    except metadata.PackageNotFoundError:
        return ()


def in_terminal(markdown: str, width: int = 100, color: bool = False) -> str:
    r"""Return the page formatted for a terminal, without a final line break.

    >>> print(in_terminal("# bare-angle\n\nAn angle\nwithout `deg`, see [here](x.md).\n\n```yaml\nrecipe: 1\n```\n"))
    bare-angle
    <BLANKLINE>
    An angle without `deg`, see here.
    <BLANKLINE>
        recipe: 1
    """
    paint = Paint(color)
    return "\n\n".join("\n".join(_shown(block, width, paint)) for block in _blocks(markdown))


def _blocks(markdown: str) -> Iterator[list[str]]:
    """Yield the lines of each paragraph, heading, list or table, and of each code block with its fences."""
    block: list[str] = []
    for line in markdown.splitlines():
        fenced = bool(block) and block[0].startswith("```")
        if fenced:
            block.append(line)
            if line.startswith("```"):
                yield block
                block = []
        elif line.startswith(("```", "#")) or not line.strip():
            if block:
                yield block
            block = [line] if line.strip() else []
        else:
            block.append(line)
    if block:
        yield block


def _shown(block: list[str], width: int, paint: Paint) -> Iterator[str]:
    first = block[0]
    if first.startswith("```"):
        yield from (paint("code", f"    {line}") if line else "" for line in block[1:-1])
    elif first.startswith("#"):
        yield paint("bold", first.lstrip("# "))
    elif first.startswith("|"):
        yield from _table(block, paint)
    else:
        for text, indent in _paragraphs(block):
            # Text between backticks is not broken, because it may be a line to paste.
            whole = _CODE.sub(lambda found: found[0].replace(" ", "\0"), _LINK.sub(r"\1", text))
            for line in textwrap.wrap(whole, width, subsequent_indent=indent, break_long_words=False,
                                      break_on_hyphens=False):  # fmt: skip
                yield _colored(line.replace("\0", " "), paint)


def _paragraphs(block: list[str]) -> Iterator[tuple[str, str]]:
    """Yield each item of a list, or the one paragraph, with the indentation of its further lines."""
    text, indent = "", ""
    for line in block:
        if (item := _ITEM.match(line)) is not None:
            if text:
                yield text, indent
            text, indent = line, " " * len(item[0])
        else:
            text = f"{text} {line.strip()}" if text else line.strip()
    yield text, indent


def _table(block: list[str], paint: Paint) -> Iterator[str]:
    rows = [[cell.strip() for cell in _LINK.sub(r"\1", line).strip("|").split("|")] for line in block]
    head, _, *body = rows
    widths = [max(len(row[column]) for row in (head, *body)) for column in range(len(head))]
    for number, row in enumerate((head, *body)):
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        yield paint("bold", line) if number == 0 else _colored(line, paint)


def _colored(line: str, paint: Paint) -> str:
    return _CODE.sub(lambda found: paint("code", found[0]), line)
