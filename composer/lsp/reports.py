"""The diagnostics of an open recipe: those of its current text, and the latest ones from MuJoCo."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from composer.diagnostics.diagnostic import Diagnostic, Note, Severity
from composer.diagnostics.span import Span
from composer.lsp.analysis import Analysis, shown
from composer.lsp.lines import moved


def carried(
    found: Iterable[Diagnostic], file: str, old: Sequence[str], new: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """Return diagnostics of an earlier text at their places in a new one. Those on changed lines are left out."""
    if list(old) == list(new):
        return tuple(found)
    lines = moved(old, new)

    def there(span: Span | None) -> Span | None:
        if span is None or span.file != file:
            return span
        line, end = lines.get(span.line - 1), None if span.end_line is None else lines.get(span.end_line - 1)
        if line is None or (span.end_line is not None and end is None):
            return None
        return replace(span, line=line + 1, end_line=None if end is None else end + 1)

    kept = []
    for each in found:
        span = there(each.span)
        fix_at = None if each.fix is None else there(each.fix.span)
        if (each.span is not None and span is None) or (
            each.fix is not None and each.fix.span is not None and not fix_at
        ):
            continue
        notes = tuple(Note(note.message, there(note.span)) for note in each.notes)
        fix = None if each.fix is None else replace(each.fix, span=fix_at)
        kept.append(replace(each, span=span, notes=notes, fix=fix))
    return tuple(kept)


def together(now: Sequence[Diagnostic], verified: Sequence[Diagnostic]) -> list[Diagnostic]:
    """Return the diagnostics of the text and those from MuJoCo. If the text has errors, there is no model to judge."""
    if any(each.severity is Severity.ERROR for each in now):
        return list(now)
    return [*now, *(each for each in verified if each not in now)]


def by_file(
    found: Iterable[Diagnostic], own: str, uses: Mapping[str, Span] | None = None
) -> Mapping[str, list[Diagnostic]]:
    """Return diagnostics by the file in which they are shown. Those without a place are shown in the recipe.

    A diagnostic of a model is shown there and where the recipe uses the model, because most editors do not show the
    diagnostics of files that are not open. `uses` gives the place of use, by file.
    """
    files: dict[str, list[Diagnostic]] = {own: []}
    for each in found:
        span = each.span
        if span is None or span.file.startswith("--"):
            files[own].append(each)
            continue
        files.setdefault(span.file, []).append(each)
        if span.file != own and uses is not None:
            files[own].append(_at_use(each, span, uses.get(span.file) or Span(own, 1, 1, 1, 1)))
    return files


def _at_use(found: Diagnostic, span: Span, use: Span) -> Diagnostic:
    """Return a diagnostic about a file at the place that uses the file."""
    return replace(found, span=use, notes=(Note("it is found here", span), *found.notes), fix=None)


def uses_of(analysis: Analysis) -> dict[str, Span]:
    """Return the first place at which a recipe uses each file."""
    found: dict[str, Span] = {}
    for place in analysis.plan.walk() if analysis.plan is not None else ():
        path = getattr(place.model, "path", None)
        if place.span is not None and path is not None and place.span.file == analysis.file:
            now = analysis.now(place.span, analysis.plan_of)
            if now is not None:
                found.setdefault(shown(path, analysis.folder), now)
    return found
