"""Completion of names and globs in selectors, with the number of elements that each one matches."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from composer.lsp.answers import Item
from composer.lsp.names import Known
from composer.lsp.places import PART, fitting
from composer.lsp.question import Question
from composer.lsp.subject import wanted_as_value


def offer(question: Question) -> Iterator[Item]:
    """Yield globs that match existing elements, followed by the names themselves."""
    analysis, wanted = question.analysis, wanted_as_value(question)
    if wanted is None or not wanted.pattern:
        return
    found = [known for _, known in fitting(wanted, analysis.names, analysis.plan)]
    if wanted.namespaces != (PART,):
        yield Item(
            "**",
            "pattern",
            f"all, unnamed ones too ({_count(len(found), 'with a name', 'with a name')})",
            rank=5,
        )
        for at, (glob, count) in enumerate(_globs(found, analysis.separator)):
            yield Item(glob, "pattern", _count(count, "element", "elements"), rank=10 + at / 1000)
    for at, known in enumerate(found):
        yield Item(known.name, known.namespace, known.detail, rank=20 + min(at, 9000) / 10000)


def _globs(found: list[Known], separator: str) -> list[tuple[str, int]]:
    """Return `PREFIX/*` and `PREFIX/**` for each existing prefix, with the number of names that they match."""
    deep: Counter[str] = Counter()
    flat: Counter[str] = Counter()
    for known in found:
        steps = known.name.split(separator)
        for depth in range(1, len(steps)):
            deep[separator.join(steps[:depth])] += 1
        flat[separator.join(steps[:-1])] += 1
    globs = {f"{start}{separator}*" if start else "*": count for start, count in flat.items()}
    globs |= {f"{start}{separator}**": count for start, count in deep.items() if count != flat[start]}
    return sorted(globs.items())


def _count(count: int, one: str, several: str) -> str:
    return f"{count} {one if count == 1 else several}"
