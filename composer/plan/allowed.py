"""The warnings that a plan's recipes acknowledge with `allow`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path as File

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.sink import Sink
from composer.diagnostics.span import Span
from composer.document.node import Node, Scalar, Sequence, find, locate, spans
from composer.plan.plan import Plan
from composer.recipe.allow import ALLOW
from composer.recipe.fault import Path
from composer.sources.source import Source

Shown = Callable[[File], str]
_BEYOND = ("licence-missing", "usd-loss", "target-loss", "store-unusable", "lock-stale")
"""Warnings from outside of a single build, whose absence in a build proves nothing."""


@dataclass(frozen=True, slots=True)
class Allowance:
    """An allowed code, written at `span`: for warnings without a file, in these files, or on one of these lines.

    `everywhere` is set for codes at the top of the built recipe.
    """

    code: str
    span: Span
    everywhere: bool = False
    files: frozenset[str] = frozenset()
    lines: frozenset[tuple[str, int]] = frozenset()

    def covers(self, diagnostic: Diagnostic) -> bool:
        if diagnostic.code != self.code or diagnostic.severity is Severity.ERROR:
            return False
        span = diagnostic.span
        if self.everywhere or span is None:
            return self.everywhere
        return span.file in self.files or (span.file, span.line) in self.lines


def acknowledge(plan: Plan, sink: Sink, shown: Shown, *, whole: bool) -> None:
    """Drop the warnings that the recipes allow; with `whole`, warn of allowed codes that do not occur.

    `shown` returns a file's name in messages. Errors stay.
    """
    allowances = list(_allowances(plan, shown))
    if not allowances:
        return
    used = set()
    for diagnostic in sink.diagnostics:
        covering = [each for each in allowances if each.covers(diagnostic)]
        used.update(covering)
        if covering:
            sink.drop(diagnostic)
    for each in allowances if whole and not sink.has_errors else ():
        if each not in used and each.code not in _BEYOND:
            sink.warning("unused-allow", f"nothing warns of `{each.code}` here", each.span,
                         help=f"take `{each.code}` out")  # fmt: skip


def allowed_everywhere(plan: Plan) -> tuple[str, ...]:
    """Return the codes at the top of the built recipe."""
    node = find(plan.document, (ALLOW,))
    return tuple(code for code, _ in _codes(node))


def _allowances(plan: Plan, shown: Shown) -> Iterator[Allowance]:
    for inner in plan.plans():
        everywhere = inner is plan
        files = frozenset() if everywhere else frozenset([inner.file, *_files(inner, shown)])
        for code, span in _codes(find(inner.document, (ALLOW,))):
            yield Allowance(code, span, everywhere, files=files)
        for edit in inner.edits:
            yield from _of_item(inner, edit.edit.at)
        yield from _of_model(inner, ("base",), inner.base.model, shown=shown)
        for part in inner.parts:
            yield from _of_model(inner, part.at, part.model, shown=shown)


def _of_model(plan: Plan, at: Path, model: Source | Plan | None, shown: Shown) -> Iterator[Allowance]:
    """Yield what the base or a part allows: in its entry of the recipe, and in its files."""
    files = [shown(model.path)] if isinstance(model, Source) else []
    if isinstance(model, Plan):
        files = [model.file, *_files(model, shown)]
    yield from _of_item(plan, at, frozenset(files))
    edits = find(plan.document, (*at, "edit"))
    for index in range(len(edits.items)) if isinstance(edits, Sequence) else ():
        yield from _of_item(plan, (*at, "edit", index))


def _of_item(plan: Plan, at: Path, files: frozenset[str] = frozenset()) -> Iterator[Allowance]:
    codes = list(_codes(find(plan.document, (*at, ALLOW))))
    node = find(plan.document, at) if codes else None
    if node is not None:
        places = [*spans(node), locate(plan.document, at, key=True)]
        lines = frozenset(
            (span.file, line)
            for span in places
            for line in range(span.line, (span.end_line or span.line) + 1)
        )
        for code, span in codes:
            yield Allowance(code, span, False, files=files, lines=lines)


def _files(plan: Plan, shown: Shown) -> Iterator[str]:
    for inner in plan.plans():
        yield inner.file
    for source in plan.sources():
        yield shown(source.path)


def _codes(node: Node | None) -> Iterator[tuple[str, Span]]:
    for item in node.items if isinstance(node, Sequence) else ():
        if isinstance(item, Scalar):
            yield item.text, item.span
