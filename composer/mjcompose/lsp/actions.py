"""All kinds of code actions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path

from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import Diagnostic, Severity, Span
from mjcompose.base.suggest import closest
from mjcompose.language.forms.scalars import ALLOW
from mjcompose.lint.rule import rules
from mjcompose.lsp.analysis import Action, Analysis, Question
from mjcompose.lsp.completion import complete
from mjcompose.lsp.cursor import Path as Steps
from mjcompose.lsp.hover import SECTIONS
from mjcompose.lsp.markup import ModelQuestion
from mjcompose.sources.fetching import model_files
from mjcompose.text.expression import Angle
from mjcompose.text.faults import quoted, word
from mjcompose.text.node import Mapping, TextChange, find, position, with_item, with_key
from mjcompose.tools.fix import edit_of, place_of


class Offer(Struct, slots=False):
    """A place in a recipe, with the diagnostics that the editor shows there."""

    question: Question
    diagnostics: tuple[Diagnostic, ...]

    @property
    def analysis(self) -> Analysis:
        return self.question.analysis

    @cached_property
    def tree(self) -> Mapping | None:
        return self.analysis.mapping if self.analysis.is_current else None

    def with_key(self, path: Steps, value: str) -> TextChange | None:
        analysis = self.analysis
        tree = self.tree
        return None if tree is None else with_key(tree, analysis.lines, analysis.file, path, value)


def offer(offered: Offer) -> Iterator[Action]:
    """Yield, for each warning at the place, a change that adds its code to `allow`."""
    tree = offered.tree
    analysis = offered.analysis
    for diagnostic in offered.diagnostics:
        if diagnostic.severity is not Severity.ERROR and diagnostic.code != "unused-allow" and tree is not None:
            change = with_item(tree, analysis.lines, analysis.file, ALLOW, diagnostic.code)
            if change is not None:
                yield Action(f"acknowledge this: `{ALLOW}: [{diagnostic.code}]`", (change,), diagnostic)


_CODES = ("unknown-name", "attach-place", "selector")
_MOST = 3


def offer_attach(offered: Offer) -> Iterator[Action]:
    """Yield an `attach` entry for the prefix of an unknown name. Models with a similar name come first."""
    tree = offered.tree
    analysis = offered.analysis
    attach = None if tree is None else find(tree, ("attach",))
    parts = attach.entries if isinstance(attach, Mapping) else {}
    if tree is not None:
        for diagnostic in offered.diagnostics:
            if diagnostic.code in _CODES:
                for subject in sorted(diagnostic.subjects):
                    key, separator, _ = subject.partition(analysis.separator)
                    if not separator or not key.isidentifier() or key in parts:
                        continue
                    files = model_files(analysis.path.parent)
                    near = [f"./{each}" for each in files if key.lower() in Path(each).name.lower()]
                    for model in near[:_MOST] or ["./MODEL.xml"]:
                        change = offered.with_key(("attach", key), f"{{model: {word(model)}}}")
                        if change is not None:
                            yield Action(f"attach `{key}`: `{model}`", (change,), diagnostic)


def offer_fixes(offered: Offer) -> Iterator[Action]:
    text = offered.analysis.text
    file = offered.analysis.file
    for diagnostic in offered.diagnostics:
        place = place_of(diagnostic)
        edit = edit_of(diagnostic, text) if place is not None and place.file == file else None
        if edit is not None:
            line, column = position(text, edit.start)
            end_line, end_column = position(text, edit.end)
            change = TextChange(Span(file, line, column, end_line=end_line, end_column=end_column), edit.text)
            title = (diagnostic.help or f"write `{change.text}`").partition("\n")[0]
            yield Action(title, (change,), diagnostic, is_preferred=True)


def offer_near(offered: Offer) -> Iterator[Action]:
    question = offered.question
    cursor = question.cursor
    written = cursor.whole.strip()
    unfixed = (each for each in offered.diagnostics if each.fix is None)
    about = next((each for each in unfixed if written in map(str.strip, each.subjects)), None)
    if about is None or not written:
        return
    labels = [item.label for item in complete(question).items if item.kind != "pattern"]
    for near in closest(written, [each for each in labels if each != written], _MOST):
        text = quoted(near)[1:-1] if cursor.quote else word(near)
        yield Action(f"write `{near}`", (TextChange(question.word, text),), about)


def offer_settle(offered: Offer) -> Iterator[Action]:
    """Yield, for each value that a part has, a change that writes it into the recipe."""
    for diagnostic in offered.diagnostics:
        settings = _settings(diagnostic, offered.analysis) if diagnostic.code == "option-conflict" else ()
        for part, path, value in dict.fromkeys(settings):
            words = value.split()
            text = word(value) if len(words) == 1 else f"[{', '.join(words)}]"
            change = offered.with_key(path, text)
            if change is not None:
                yield Action(f"settle `{'.'.join(path)}: {text}` as in `{part}`", (change,), diagnostic)


def _settings(diagnostic: Diagnostic, analysis: Analysis) -> Iterator[tuple[str, tuple[str, ...], str]]:
    """Yield part, path and value of each setting that is written at a place of the diagnostic."""
    spans = (diagnostic.span, *(note.span for note in diagnostic.notes))
    places = {(span.file, span.line, span.column) for span in spans if span is not None}
    for part, unit in analysis.names.sources.items():
        for section in SECTIONS:
            for top in unit.root.iterchildren(section):
                for element in top.iter("*"):
                    steps = (section,) if element is top else (section, str(element.tag))
                    for name, value in element.items():
                        at = unit.origins.span(element, unit.file, str(name))
                        if (at.file, at.line, at.column) in places:
                            yield part, (*steps, str(name)), str(value)


def offer_ignore(offered: Offer) -> Iterator[Action]:
    """Yield, for each finding of a rule in a model, a comment that ignores it."""
    lines = offered.question.lines
    file = offered.analysis.file
    for diagnostic in offered.diagnostics:
        span = diagnostic.span
        if diagnostic.code in rules() and span is not None and span.file == file:
            line = lines[span.line - 1] if span.line <= len(lines) else ""
            comment = f"<!-- mjcompose: ignore[{diagnostic.code}] -->"
            text = f"{line[: len(line) - len(line.lstrip())]}{comment}\n"
            change = TextChange(Span(file, span.line, 1, end_line=span.line, end_column=1), text)
            yield Action(f"ignore this: `{comment}`", (change,), diagnostic)


_OTHER = {"deg": "rad", "rad": "deg"}


def offer_units(offered: Offer) -> Iterator[Action]:
    """Yield `90deg` as radians and `1.57rad` as degrees; for a reported angle without a unit, both units."""
    question = offered.question
    written = question.cursor.whole.strip()
    for unit, other in _OTHER.items():
        if written.endswith(unit) and (angle := Angle.read(written)) is not None:
            text = f"{angle.in_unit(other):.10g}{other}"
            yield Action(f"write it as `{text}`", (TextChange(question.word, text),), kind="refactor.rewrite")
    for diagnostic in offered.diagnostics:
        if diagnostic.code == "bare-angle":
            for unit in _OTHER:
                if Angle.read(f"{written}{unit}") is not None:
                    change = TextChange(question.word, f"{written}{unit}")
                    yield Action(f"it is in {unit}: `{written}{unit}`", (change,), diagnostic)


OFFERS: tuple[Callable[[Offer], Iterator[Action]], ...] = (
    offer_fixes,
    offer_near,
    offer_settle,
    offer_attach,
    offer_units,
    offer,
)


def actions(offered: Offer) -> list[Action]:
    """Return the changes that are offered at a place. The fixes of diagnostics come first."""
    found: dict[tuple[str, object], Action] = {}
    offers = (offer_fixes, offer_near, offer_ignore) if isinstance(offered.question, ModelQuestion) else OFFERS
    for offer in offers:
        for action in offer(offered):
            found.setdefault((action.title, action.changes), action)
    return list(found.values())
