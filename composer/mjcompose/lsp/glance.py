"""Diagnostics for each keystroke in a long recipe: faults of the text, and of the entries on the changed lines.

Everything else waits for a pause. Other diagnostics of the last analysis move with their lines.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence as Items
from dataclasses import replace

from mjcompose.base.diagnostic import Diagnostic, Note, Span
from mjcompose.base.sink import Sink, TooManyFaults
from mjcompose.language.expand import expand
from mjcompose.language.recipe import SETTLED
from mjcompose.language.validate import validate_what_remains
from mjcompose.lsp.analysis import Analysis, moved, span_after
from mjcompose.lsp.reread import reread
from mjcompose.plan.read import EXTENDS
from mjcompose.text.load import load
from mjcompose.text.node import Mapping, Node, Sequence, lines_of

_LONG = 300
"""The number of lines from which a recipe is long; a shorter one is analyzed for each keystroke."""
_SLOW = 0.15
"""The seconds of processor time from which an analysis is too slow for each keystroke."""
_OF_TEXT = "yaml-"
_FEW = 8
"""The most entries of a section that is validated whole."""


def waits_for_pause(text: str, seconds: float) -> bool:
    """Return whether the analysis of a recipe, which last took these seconds, waits until nobody types."""
    return seconds > _SLOW and text.count("\n") > _LONG


def glance(text: str, before: Analysis) -> Analysis:
    """Return the last analysis with the tree of a new text and the certain faults of its changed lines."""
    sink = Sink()
    lines = lines_of(text)
    try:
        tree = _reread(lines, before)
        if tree is None:
            tree = load(text, before.file, sink)
        found = sink.sorted()
        if tree is not None:
            places = moved(before.lines, lines)
            changed = frozenset(range(len(lines))) - frozenset(places.values())
            of_recipe = (each for each in before.found if not each.code.startswith(_OF_TEXT))
            kept = carried(of_recipe, before.file, before.lines, lines)
            own = [each for each in faults_of_entries(tree, len(lines), changed) if each not in kept]
            found = [*found, *kept, *own]
    except TooManyFaults as too_many:
        tree = None
        found = too_many.sink.sorted()
    glanced = replace(
        before,
        text=text,
        tree=before.tree if tree is None else tree,
        found=tuple(found),
        is_current=tree is not None,
        is_composed=False,
        tree_of=before.tree_of if tree is None else text,
    )
    if "names" in vars(before):  # the model is the same
        vars(glanced)["names"] = before.names
    return glanced


def _reread(lines: list[str], before: Analysis) -> Node | None:
    """Return the tree of the text, if it follows from the last tree, whose text had no faults of YAML."""
    has_faults = not before.is_current or any(each.code.startswith(_OF_TEXT) for each in before.found)
    return None if has_faults or before.tree is None else reread(before.tree, before.lines, lines, before.file)


def faults_of_entries(tree: Node, count: int, changed: Collection[int]) -> Iterator[Diagnostic]:
    """Yield the faults on the `changed` lines, counted from 0, that a recipe of `count` lines certainly has.

    Only the entries on these lines are read. They may use names that other entries and files declare, so a name that
    does not exist here is not a certain fault.
    """
    if not isinstance(tree, Mapping) or EXTENDS in tree.entries or not changed:
        return
    reduced = _reduced(tree, count, changed)
    concrete = expand(reduced, {}, Sink())
    sink = Sink()
    validate_what_remains(concrete.document, sink, concrete.gone)
    for each in sink.sorted():
        if each.span is not None and each.span.line - 1 in changed:
            yield each


def _reduced(tree: Mapping, count: int, changed: Collection[int]) -> Mapping:
    """Return a recipe whose long sections have only the entries on the changed lines."""
    entries = {}
    for name, (key, value) in tree.entries.items():
        kept: Node = value
        if name not in SETTLED and isinstance(value, Mapping) and len(value.entries) > _FEW:
            starts = [each.span.line - 1 for each, _ in value.entries.values()]
            pairs = zip(value.entries.items(), _on_lines(starts, count, changed), strict=True)
            kept = Mapping({own: entry for (own, entry), is_changed in pairs if is_changed}, value.span)
        elif isinstance(value, Sequence) and len(value.items) > _FEW:
            starts = [each.span.line - 1 for each in value.items]
            pairs_of_items = zip(value.items, _on_lines(starts, count, changed), strict=True)
            kept = Sequence(tuple(item for item, is_changed in pairs_of_items if is_changed), value.span)
        entries[name] = (key, kept)
    return Mapping(entries, tree.span)


def _on_lines(starts: Items[int], count: int, changed: Collection[int]) -> Iterator[bool]:
    """Yield for each entry, which begins on a line, whether it is on a changed line."""
    for start, end in zip(starts, [*starts[1:], count], strict=True):
        yield any(line in changed for line in range(start, max(end, start + 1)))


def carried(found: Iterable[Diagnostic], file: str, old: Items[str], new: Items[str]) -> tuple[Diagnostic, ...]:
    """Return diagnostics of an earlier text at their places in a new one. Diagnostics on changed lines are left out."""
    if list(old) == list(new):
        return tuple(found)
    lines = moved(old, new)

    def there(span: Span | None) -> Span | None:
        return span if span is None or span.file != file else span_after(span, lines)

    kept = []
    for each in found:
        span = there(each.span)
        fix = each.fix
        if fix is not None and fix.span is not None:
            fix = replace(fix, span=there(fix.span))
            if fix.span is None:
                continue
        if each.span is None or span is not None:
            notes = tuple(Note(note.message, there(note.span)) for note in each.notes)
            kept.append(replace(each, span=span, notes=notes, fix=fix))
    return tuple(kept)
