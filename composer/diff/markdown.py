"""A diff as Markdown, for a pull request."""

from __future__ import annotations

import re
from collections.abc import Iterator

from composer.diagnostics.text import printable
from composer.diff.change import Diff, Group
from composer.diff.text import at_defaults, following, place, verdict
from composer.diff.words import count, moved, sentences, view

_LONG = 12
_LONGEST = 60_000
"""Characters. GitHub allows 65536 in a comment."""


def render(diff: Diff) -> str:
    """Return headings by line, the lines as a diff, the changes as a list; cut to the length of a comment."""
    text = printable("\n".join(_lines(diff))).strip() + "\n"
    if len(text) <= _LONGEST:
        return text
    kept = text[:_LONGEST].rpartition("\n#### ")[0]
    kept += "\n\n</details>" * (kept.count("<details>") - kept.count("</details>"))
    return f"{kept}\n\n… and more: `mjcompose diff` prints all of it.\n"


def _lines(diff: Diff) -> Iterator[str]:
    yield f"### {_code(diff.a.named)} → {_code(diff.b.named)}"
    yield ""
    yield f"**{verdict(diff).capitalize()}.**"
    for said in (end.said_outside for end in (diff.a, diff.b)):
        if said:
            yield from ("", f"<sub>{said}</sub>")
    if (narrow := at_defaults(diff)) is not None:
        yield ""
        yield f"<sub>{narrow[0].upper()}{narrow[1:]}</sub>"
    contrast = diff.contrast
    if contrast.counts:
        yield ""
        yield from (f"- {count(each)}" for each in contrast.counts)
    for group in diff.groups:
        yield ""
        yield from _group(group)
    if contrast.moves:
        yield ""
        yield "#### Addresses"
        yield ""
        yield from _list([*moved(contrast.moves)])
    if contrast.arrays:
        yield ""
        yield f"Arrays of `mjModel` that differ: {', '.join(map(_code, contrast.arrays))}"
    if diff.views:
        yield ""
        yield "#### Pictures"
        yield ""
        yield "| view | before | after |"
        yield "|---|---|---|"
        yield from (
            f"| {_code(each.name)}<br>{view(each)} | ![before](<{each.before}>) | ![after](<{each.after}>) |"
            for each in diff.views
        )
    if (more := following(diff)) is not None:
        yield ""
        yield f"<sub>{more}</sub>"


def _group(group: Group) -> Iterator[str]:
    if group.cause is None:
        yield "#### Without a line of its own"
    else:
        words = (
            "" if group.cause.lines_before or group.cause.lines_after else f": {_escaped(group.cause.words)}"
        )
        yield f"#### {_code(place(group.cause))}{words}"
        lines = [f"- {line}" for line in group.cause.lines_before] + [
            f"+ {line}" for line in group.cause.lines_after
        ]
        if lines:
            fence = "`" * max(3, 1 + max(len(each) for each in re.findall("`*", " ".join(lines))))
            yield f"{fence}diff"
            yield from lines
            yield fence
    yield ""
    yield from _list(list(sentences(group.changes)))


def _list(lines: list[str]) -> Iterator[str]:
    """Yield a list, folded if it is long."""
    if len(lines) > _LONG:
        yield f"<details><summary>{len(lines)} changes</summary>"
        yield ""
    for line in lines:
        yield f"- {_escaped(line)}"
    if len(lines) > _LONG:
        yield ""
        yield "</details>"


def _escaped(line: str) -> str:
    """Escape what Markdown would interpret outside of backquotes."""
    pieces = line.split("`")
    pieces[::2] = [re.sub(r"([\\*_<>#|])", r"\\\1", piece) for piece in pieces[::2]]
    return "`".join(pieces)


def _code(text: str) -> str:
    fence = "`" * (1 + max(len(each) for each in re.findall("`*", text)))
    return f"{fence}{text}{fence}" if fence == "`" else f"{fence} {text} {fence}"
