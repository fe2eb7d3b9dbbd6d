"""The lines of a recipe or source that a place means."""

from __future__ import annotations

from textwrap import dedent

from composer.diagnostics.span import Span
from composer.diff.side import Side

_SHOWN = 6


def block(span: Span | None, side: Side) -> list[str]:
    """The line of a place, and those below it that are indented deeper; the whole start tag in XML."""
    if span is None:
        return []
    lines = side.lines(span.file)
    if not 0 < span.line <= len(lines):
        return []
    first = lines[span.line - 1]
    block = [first]
    depth = len(first) - len(first.lstrip())
    for line in lines[span.line :]:
        if is_yaml(span):
            if line.strip() and len(line) - len(line.lstrip()) <= depth:
                break
        elif ">" in block[-1]:
            break
        if line.strip():
            block.append(line)
    return block


def excerpt(lines: list[str]) -> tuple[str, ...]:
    """The first lines, as far to the left as they go."""
    cut = [line.rstrip() for line in lines[:_SHOWN]]
    if len(lines) > _SHOWN:
        cut.append(cut[-1][: len(cut[-1]) - len(cut[-1].lstrip())] + "…")
    return tuple(dedent("\n".join(cut)).split("\n")) if cut else ()


def is_yaml(span: Span | None) -> bool:
    """Whether it is a place in a recipe."""
    return span is not None and span.file.endswith((".yaml", ".yml"))


def different(lines: list[str], others: list[str]) -> list[str]:
    """The lines that the others do not have, indentation aside."""
    known = {line.strip() for line in others}
    return [line for line in lines if line.strip() not in known]
