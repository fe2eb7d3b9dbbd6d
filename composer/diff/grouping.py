"""Changes by the line that is the reason for them, with the words that stand there in A and in B."""

from __future__ import annotations

from collections.abc import Iterable
from textwrap import dedent

from composer.diagnostics.span import Span
from composer.diff.cause import Causes
from composer.diff.change import Cause, Change, Group
from composer.diff.side import Side

_SHOWN = 6


def grouped(changes: Iterable[Change], causes: Causes, a: Side, b: Side) -> list[Group]:
    """One group a line, in the order of files and lines; last what no line is known for."""
    found: dict[tuple[object, ...], tuple[Cause | None, list[Change]]] = {}
    for change in changes:
        cause = causes.of(change)
        known, several = found.setdefault(_key(cause), (cause, []))
        several.append(change)
        if known is not None and known.before is None and cause is not None and cause.before is not None:
            found[_key(cause)] = cause, several
    groups = [Group(_worded(cause, a, b), tuple(each)) for cause, each in found.values()]
    return sorted(groups, key=_place)


def _key(cause: Cause | None) -> tuple[object, ...]:
    """What B's line makes stands together, whether A has a line for it or not."""
    span = None if cause is None else cause.after or cause.before
    return (None,) if span is None else (cause is not None and cause.after is not None, span.file, span.line)


def _place(group: Group) -> tuple[bool, bool, str, int]:
    """Recipes before sources: what is nearest to the user first."""
    span = None if group.cause is None else group.cause.after or group.cause.before
    if span is None:
        return True, True, "", 0
    return False, not span.file.endswith((".yaml", ".yml")), span.file, span.line


def _worded(cause: Cause | None, a: Side, b: Side) -> Cause | None:
    """The cause with its lines, which are those that differ where the first one does not."""
    if cause is None:
        return None
    before, after = _block(cause.before, a), _block(cause.after, b)
    if cause.before is not None and cause.after is not None:
        ours, theirs = _different(before, after), _different(after, before)
        before, after = ours, theirs
    else:
        before, after = (
            lines if _is_yaml(span) else lines[:1]
            for lines, span in ((before, cause.before), (after, cause.after))
        )
    return Cause(
        cause.words,
        None if cause.before is None else a.operand.located(cause.before),
        None if cause.after is None else b.operand.located(cause.after),
        _excerpt(before),
        _excerpt(after),
    )


def _block(span: Span | None, side: Side) -> list[str]:
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
        if _is_yaml(span):
            if line.strip() and len(line) - len(line.lstrip()) <= depth:
                break
        elif ">" in block[-1]:
            break
        if line.strip():
            block.append(line)
    return block


def _excerpt(lines: list[str]) -> tuple[str, ...]:
    """The first lines, as far to the left as they go."""
    cut = [line.rstrip() for line in lines[:_SHOWN]]
    if len(lines) > _SHOWN:
        cut.append(cut[-1][: len(cut[-1]) - len(cut[-1].lstrip())] + "…")
    return tuple(dedent("\n".join(cut)).split("\n")) if cut else ()


def _is_yaml(span: Span | None) -> bool:
    return span is not None and span.file.endswith((".yaml", ".yml"))


def _different(lines: list[str], others: list[str]) -> list[str]:
    known = {line.strip() for line in others}
    return [line for line in lines if line.strip() not in known]
