"""A diff for a terminal."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diff.change import Cause, Diff, Group
from composer.diff.words import count, moved, sentences, view


def render(diff: Diff) -> str:
    """Return the full report, line by line."""
    return "\n".join(_lines(diff))


def verdict(diff: Diff) -> str:
    """Return the result in one sentence."""
    if diff.same and diff.contrast.identical:
        files = "and so are all files" if diff.same_bytes else "though their files are not"
        return f"the same: the compiled models are equal bit for bit, {files}"
    if diff.same:
        return "the same in what was asked for; the compiled models are not equal bit for bit"
    changes = sum(len(group.changes) for group in diff.groups)
    if not changes:
        contrast = diff.contrast
        kinds = {"counts": contrast.counts, "addresses": contrast.moves, "arrays of mjModel": contrast.arrays}
        return f"different: only {' and '.join(kind for kind, found in kinds.items() if found)}"
    causes = sum(group.cause is not None for group in diff.groups)
    many = "1 change" if changes == 1 else f"{changes} changes"
    where = f" at {causes} place{'s' if causes != 1 else ''}" if causes else ""
    return f"different: {many}{where}"


def place(cause: Cause) -> str:
    """Return `recipe.yaml:12`, with A's place if it is another one, and not only in another revision."""
    spans = [None if span is None else f"{span.file}:{span.line}" for span in (cause.before, cause.after)]
    if spans[0] is None or spans[0] == spans[1] or (spans[1] and spans[0].endswith(f":{spans[1]}")):
        return str(spans[1])
    if spans[1] is None:
        return f"{spans[0]} (A)"
    return f"{spans[0]} → {spans[1]}"


def heading(cause: Cause) -> str:
    """Return the place, and in words what its lines do not show."""
    has_lines = cause.lines_before or cause.lines_after
    return place(cause) if has_lines else f"{place(cause)}: {cause.words}"


def following(diff: Diff) -> str | None:
    """Return how many changes are not listed one by one."""
    if not diff.follows:
        return None
    many = "1 number" if diff.follows == 1 else f"{diff.follows} numbers"
    return (
        f"{many} that MuJoCo computes from these differ{'s' * (diff.follows == 1)} too: --computed lists them"
    )


def at_defaults(diff: Diff) -> str | None:
    """Return a remark that a matrix was compared at its defaults, or None if there is none or a cell was picked."""
    counts = [end.cells for end in (diff.a, diff.b) if end.cells]
    if not counts:
        return None
    cells = "1 cell" if counts[-1] == 1 else f"{counts[-1]} cells"
    return f"compared at its defaults: of the {cells} of the matrix, `--pick CELL` compares one"


def _lines(diff: Diff) -> Iterator[str]:
    yield f"A {diff.a.named}"
    yield f"B {diff.b.named}"
    yield verdict(diff)
    yield from (said for end in (diff.a, diff.b) if (said := end.said_outside))
    if (narrow := at_defaults(diff)) is not None:
        yield narrow
    contrast = diff.contrast
    if contrast.counts:
        yield ""
        yield "the whole model"
        yield from (f"  {count(each)}" for each in contrast.counts)
    for group in diff.groups:
        yield ""
        yield from _group(group)
    if contrast.moves:
        yield ""
        yield "addresses"
        yield from (f"  {each}" for each in moved(contrast.moves))
    if contrast.arrays:
        yield ""
        yield f"arrays of mjModel that differ: {', '.join(contrast.arrays)}"
    if diff.views:
        yield ""
        yield "pictures"
        yield from (f"  {each.name}: {view(each)}: {each.before}, {each.after}" for each in diff.views)
    if (more := following(diff)) is not None:
        yield ""
        yield more
    if diff.same_bytes != diff.same and diff.files:
        yield ""
        yield f"files that differ: {', '.join(diff.files)}"


def _group(group: Group) -> Iterator[str]:
    if group.cause is None:
        yield "without a line of its own"
    else:
        yield heading(group.cause)
        yield from (f"  - {line}" for line in group.cause.lines_before)
        yield from (f"  + {line}" for line in group.cause.lines_after)
    indent = "    " if group.cause is not None else "  "
    yield from (f"{indent}{each}" for each in sentences(group.changes))
