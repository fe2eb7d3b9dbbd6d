"""The lines of a recipe or source that belong to a place."""

from __future__ import annotations

from textwrap import dedent

from composer.diagnostics.span import Span
from composer.diff.side import Side

_SHOWN = 6


def block(span: Span | None, side: Side) -> list[str]:
    """Return the lines of a place without empty ones."""
    if span is None:
        return []
    lines = side.lines(span.file)
    return [lines[number - 1] for number in extent(span, side) if lines[number - 1].strip()]


def extent(span: Span, side: Side) -> range:
    """Return the numbers of the lines that belong to a place.

    For a key or a mapping these are its line and the deeper-indented lines below it, for an element its whole start
    tag, for a value its own line alone.
    """
    lines = side.lines(span.file)
    if not 0 < span.line <= len(lines):
        return range(0)
    first, end = lines[span.line - 1], span.line
    ahead = first[: span.column - 1]
    if is_yaml(span) and not ahead.replace("-", " ").strip():
        depth = len(first) - len(first.lstrip())
        for number, line in enumerate(lines[span.line :], span.line + 1):
            if line.strip() and len(line) - len(line.lstrip()) <= depth:
                break
            if line.strip():
                end = number
    elif not is_yaml(span) and first[span.column - 1 : span.column] == "<":
        while ">" not in lines[end - 1] and end < len(lines):
            end += 1
    return range(span.line, end + 1)


def excerpt(lines: list[str]) -> tuple[str, ...]:
    """Return the first lines, dedented."""
    cut = [line.rstrip() for line in lines[:_SHOWN]]
    if len(lines) > _SHOWN:
        cut.append(cut[-1][: len(cut[-1]) - len(cut[-1].lstrip())] + "…")
    return tuple(dedent("\n".join(cut)).split("\n")) if cut else ()


def is_yaml(span: Span | None) -> bool:
    """Return whether a place is in a recipe."""
    return span is not None and span.file.endswith((".yaml", ".yml"))


def different(lines: list[str], others: list[str]) -> list[str]:
    """Return the lines that are not among the others, ignoring indentation."""
    known = {line.strip() for line in others}
    return [line for line in lines if line.strip() not in known]
