"""Code action: resolve a conflict between the settings of parts by writing the value into the recipe."""

from __future__ import annotations

from collections.abc import Iterator

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.span import Span
from composer.document.quote import word
from composer.lsp.actions.offer import Offer
from composer.lsp.analysis import Analysis
from composer.lsp.answers import Action
from composer.lsp.hover.setting import SECTIONS
from composer.lsp.writing import with_key

_CODE = "option-conflict"


def offer(offered: Offer) -> Iterator[Action]:
    """Yield, for each value that a part has, a change that writes it into the recipe."""
    tree, analysis = offered.tree, offered.analysis
    for diagnostic in offered.diagnostics if tree is not None else ():
        if diagnostic.code != _CODE or tree is None:
            continue
        for part, path, value in dict.fromkeys(_wanted(diagnostic, analysis)):
            words = value.split()
            text = word(value) if len(words) == 1 else f"[{', '.join(words)}]"
            change = with_key(tree, analysis.lines, analysis.file, path, text)
            if change is not None:
                yield Action(f"settle `{'.'.join(path)}: {text}` as `{part}` wants it", (change,), diagnostic)


def _wanted(diagnostic: Diagnostic, analysis: Analysis) -> Iterator[tuple[str, tuple[str, ...], str]]:
    """Yield part, path and value of each setting that is written at a place of the diagnostic."""
    places = {
        _line(span)
        for span in (diagnostic.span, *(note.span for note in diagnostic.notes))
        if span is not None
    }
    for part, unit in analysis.names.sources.items():
        for section in SECTIONS:
            for top in unit.root.iterchildren(section):
                for element in top.iter("*"):
                    steps = (section,) if element is top else (section, str(element.tag))
                    for name, value in element.items():
                        if _line(unit.origins.span(element, unit.file, str(name))) in places:
                            yield part, (*steps, str(name)), str(value)


def _line(span: Span) -> tuple[str, int, int]:
    return span.file, span.line, span.column
