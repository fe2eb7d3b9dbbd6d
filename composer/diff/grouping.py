"""Group changes by the line that causes them, with the text of that line in A and in B."""

from __future__ import annotations

from collections.abc import Iterable

from composer.diff.cause import Causes
from composer.diff.change import Cause, Change, Group
from composer.diff.excerpt import block, different, excerpt, is_yaml
from composer.diff.side import Side


def grouped(changes: Iterable[Change], causes: Causes, a: Side, b: Side) -> list[Group]:
    """Return one group for each line, ordered by file and line; changes without a known line come last."""
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
    """Return the key of a group. It is B's line if there is one, whether or not A has a line."""
    span = None if cause is None else cause.after or cause.before
    return (None,) if span is None else (cause is not None and cause.after is not None, span.file, span.line)


def _place(group: Group) -> tuple[bool, bool, str, int]:
    """Return the sort key of a group: recipes before sources, because they are nearest to the user."""
    span = None if group.cause is None else group.cause.after or group.cause.before
    if span is None:
        return True, True, "", 0
    return False, not span.file.endswith((".yaml", ".yml")), span.file, span.line


def _worded(cause: Cause | None, a: Side, b: Side) -> Cause | None:
    """Return the cause with its lines; if both sides have some, only those that differ."""
    if cause is None:
        return None
    before, after = block(cause.before, a), block(cause.after, b)
    if cause.before is not None and cause.after is not None:
        ours, theirs = different(before, after), different(after, before)
        before, after = ours, theirs
    else:
        before, after = (
            lines if is_yaml(span) else lines[:1]
            for lines, span in ((before, cause.before), (after, cause.after))
        )
    return Cause(
        cause.words,
        None if cause.before is None else a.operand.located(cause.before),
        None if cause.after is None else b.operand.located(cause.after),
        lines_before=excerpt(before),
        lines_after=excerpt(after),
    )
