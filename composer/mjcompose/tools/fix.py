"""Apply the fixes of diagnostics until there is nothing left to fix."""

from __future__ import annotations

import hashlib
import os
import re
from bisect import bisect
from codecs import BOM_UTF8
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import field, replace
from functools import lru_cache, partial
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from mjcompose.base.access import ALL, Door, door_of_named
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import CellName, Diagnostic, Fix, Severity, Span
from mjcompose.base.files import RECIPES, read_regular, unsaved, unsaved_text
from mjcompose.base.limits import in_force
from mjcompose.base.sink import Sink, TooManyFaults
from mjcompose.bundle.bundle import MANIFEST, Bundle
from mjcompose.language.expand import Cell
from mjcompose.mujoco.engine import Session
from mjcompose.pipeline.cache.cells import cells_of, choices_of, pick_text
from mjcompose.pipeline.stages import ModelRequest, build
from mjcompose.plan.read import Given
from mjcompose.sources.context import Context
from mjcompose.text.faults import quoted, word
from mjcompose.text.load import load
from mjcompose.text.node import OPENING

if TYPE_CHECKING:
    from mjcompose.compose.load import Library

_CLOSING = {"[": "]", "{": "}", '"': '"', "'": "'"}
_BLOCKS = ("|", ">")


class TextEdit(Struct):
    """Replaces the characters from `start` up to `end` by `text`."""

    start: int
    end: int
    text: str

    def meets(self, other: TextEdit) -> bool:
        return self.start == other.start or (self.start < other.end and other.start < self.end)


class _Apart:
    """Changes of one text that do not meet, in their order; each new one is compared with its two neighbors."""

    def __init__(self) -> None:
        self.edits: dict[TextEdit, Diagnostic] = {}
        self._places: list[tuple[int, int]] = []
        self._at: dict[tuple[int, int], TextEdit] = {}

    def add(self, edit: TextEdit, diagnostic: Diagnostic) -> None:
        """Add a change, unless it meets an earlier one."""
        place = (edit.start, edit.end)
        number = bisect(self._places, place)
        neighbors = (self._at[each] for each in self._places[max(number - 1, 0) : number + 1])
        if any(edit.meets(neighbor) for neighbor in neighbors):
            return
        self._places.insert(number, place)
        self._at[place] = edit
        self.edits[edit] = diagnostic


def edit_of(diagnostic: Diagnostic, source: str) -> TextEdit | None:
    """Return the change to a file's text for a diagnostic's fix, or None if there is no fix or it does not fit.

    A fix does not fit if it drops a template, whose value may differ in each model, or makes a recipe wrong as YAML.

    >>> span = Span("a.yaml", 1, 7, 1, 13)
    >>> edit_of(Diagnostic("unknown-name", "no", span, fix=Fix("arm/tip", "tipp")), 'site: "tipp"')
    TextEdit(start=6, end=12, text='"arm/tip"')
    >>> edit_of(Diagnostic("unknown-name", "no", span, fix=Fix("tip", "tipp")), 'site: "other"')
    """
    fix = diagnostic.fix
    span = place_of(diagnostic)
    if fix is None or span is None:
        return None
    bounds = _bounds(span, source, is_verbatim=fix.replaces is None and fix.span is not None)
    if bounds is None:
        return None
    start, end = bounds
    written = source[start:end]
    text = fix.replacement if fix.replaces is None else _renamed(written, fix, span.file.endswith(RECIPES))
    if text is None or not keeps_templates(written, text):
        return None
    if fix.replaces is None and (_is_cut_off(written) or written.startswith(_BLOCKS)):
        return None
    edit = TextEdit(start, end, text)
    if not span.file.endswith(RECIPES):
        return edit
    start, end = _piece_to_read(source, edit)
    before = source[start:end]
    after = applied(before, [TextEdit(edit.start - start, edit.end - start, edit.text)])
    return edit if _yaml_faults(after) <= _yaml_faults(before) else None


def _piece_to_read(source: str, edit: TextEdit) -> tuple[int, int]:
    """Return the part of a text that shows whether a change makes it wrong as YAML: the line, or all of the text.

    Reading all of the text for each of many fixes would take N² time. A line is enough if the change is behind its
    first key, and nothing on the next lines belongs to it.
    """
    begins = _line_starts(source)
    number = bisect(begins, edit.start) - 1
    start = begins[number]
    end = begins[number + 1] if number + 1 < len(begins) else len(source)
    whole = (0, len(source))
    line = source[start:end]
    indent = _indent(line)
    head = line[: edit.start - start]
    if edit.end > end or head.strip(" -") == "" or not line.strip():
        return whole
    for following in range(number + 1, len(begins)):
        after = begins[following + 1] if following + 1 < len(begins) else len(source)
        below = source[begins[following] : after]
        if below.strip() and not below.lstrip().startswith("#"):
            if _indent(below) > indent:
                return whole
            break
    return (start + indent, end) if not _yaml_faults(line[indent:]) else whole


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip(" "))


@lru_cache(maxsize=16)
def _line_starts(source: str) -> list[int]:
    return [0, *(found.end() for found in re.finditer(r"\r\n|\n|\r", source))]


@lru_cache(maxsize=16)
def _yaml_faults(text: str) -> int:
    """Return the number of faults in a text as YAML, such as a key that appears twice."""
    sink = Sink()
    load(text, "", sink)
    return sink.error_count


def keeps_templates(before: str, after: str) -> bool:
    """Return whether a new text still has every `${…}` of the old text, which computes a value for each model.

    >>> keeps_templates("${r}", '"${r}"'), keeps_templates("${tilt}", "10deg")
    (True, False)
    """
    _, *inside = before.split(OPENING)
    return all(f"{OPENING}{each.partition('}')[0]}" in after for each in inside)


def _is_cut_off(written: str) -> bool:
    """Return whether a value goes on after this text. The span of a value over several lines ends with its first."""
    closing = _CLOSING.get(written[:1])
    return closing is not None and (len(written) == 1 or written[-1] != closing)


def exact(diagnostic: Diagnostic, source: str) -> Diagnostic:
    """Return the diagnostic with the verbatim text of its fix, including quotes, or without a fix that does not fit."""
    if diagnostic.fix is None:
        return diagnostic
    edit = edit_of(diagnostic, source)
    return replace(diagnostic, fix=None if edit is None else Fix(edit.text, None, place_of(diagnostic)))


def place_of(diagnostic: Diagnostic) -> Span | None:
    return diagnostic.fix.span or diagnostic.span if diagnostic.fix is not None else None


def applied(source: str, edits: Iterable[TextEdit]) -> str:
    """Return the text with all changes; if two changes overlap, only the first one is made.

    >>> applied("a b c", [TextEdit(0, 1, "x"), TextEdit(4, 5, "z"), TextEdit(0, 3, "y")])
    'x b z'
    """
    result = ""
    done = 0
    for edit in sorted(dict.fromkeys(edits), key=lambda each: (each.start, each.end)):
        if edit.start >= done:
            result += source[done : edit.start] + edit.text
            done = edit.end
    return result + source[done:]


def _bounds(span: Span, source: str, is_verbatim: bool = False) -> tuple[int, int] | None:
    """Return the positions of a span, or None for several lines of a text that is not replaced verbatim.

    A span without an end is empty.
    """
    last = span.end_line or span.line
    if last != span.line and not is_verbatim:
        return None
    begins = _line_starts(source)
    if not 1 <= span.line <= last <= len(begins):
        return None
    start = begins[span.line - 1] + span.column - 1
    end = start if span.end_column is None else begins[last - 1] + span.end_column - 1
    line_end = begins[last] if last < len(begins) else len(source)
    return (start, end) if start <= end <= line_end else None


def _renamed(written: str, fix: Fix, is_yaml: bool) -> str | None:
    """Return another name in the necessary quotes, or None if the old one is not in the text."""
    quotes = written[:1] if written[:1] in ("'", '"') and written[-1:] == written[:1] and len(written) > 1 else ""
    if (written[1:-1] if quotes else written) != fix.replaces:
        return None
    if not is_yaml:
        return f"{quotes}{fix.replacement}{quotes}"
    return quoted(fix.replacement) if quotes else word(fix.replacement)


_ROUNDS = 50

Identity = tuple[str, str, str]
"""A finding without its place, which a fix above it moves: file, code and message."""


class Judged(Struct):
    """A model of a recipe and its findings. `digest` stands for its files; it is None after errors.

    `cell` is None for the model with the default values, and for a file that is not a recipe.
    """

    cell: CellName | None
    found: tuple[Diagnostic, ...]
    digest: str | None = None

    @property
    def has_errors(self) -> bool:
        return any(each.severity is Severity.ERROR for each in self.found)

    @property
    def is_cut_off(self) -> bool:
        """Whether there are more faults than the limit allows to find."""
        return any(each.code == "limit-exceeded" for each in self.found)


class Fixed(Struct, frozen=False):
    """The result of fixing a recipe.

    `files` has the texts before and after by path. `fixed` has the fixed diagnostics, and `left` has the others.
    `outside` are files with fixes that the `door` does not allow to change.
    """

    files: dict[Path, tuple[bytes, bytes]] = field(default_factory=dict)
    fixed: list[Diagnostic] = field(default_factory=list)
    left: tuple[Diagnostic, ...] = ()
    outside: tuple[Path, ...] = ()
    door: Door = ALL


def fix(recipe: Path, context: Context, given: Given | None = None) -> Fixed:
    """Return the fixed texts of a recipe and of the user's own recipes that it uses; nothing is written.

    Each fix is tried on every model of the recipe. A fix is reverted if it leaves its fault in one of them, brings
    another fault, or changes a model that did not have the fault.
    """
    look = partial(models_of, recipe, given=given or {})
    return Fixing(look, context, door=door_of_named(context.folder / recipe)).fixed()


def models_of(
    recipe: Path, context: Context, given: Given, *, most: int | None = None, verified: bool = False
) -> list[Judged]:
    """Return the model with the default values, every cell of the matrix, and every value of the variants.

    A cell that draws is built without draws and as its first sample: the others read the same lines. `most` limits
    the number of models. If not `verified`, MuJoCo compiles only the units that the linker has to measure.
    """
    library: Library = {}
    with Session() as session:

        def judged(cell: Cell | None, given: Given) -> Judged:
            own = replace(context, sink=Sink(), timings=[])
            name, sample = (None, 0) if cell is None else (cell.name, cell.sample)
            request = ModelRequest(recipe, given, name, sample=sample, verified=verified)
            label = None if cell is None else cell.label
            try:
                built = build(request, own, session=session, library=library)
            except TooManyFaults as too_many:
                # The faults up to the limit have fixes, too, and the next round finds the others.
                return Judged(label, tuple(too_many.sink.sorted()))
            digest = None if built is None else _digest(built.bundle)
            return Judged(label, tuple(own.sink.sorted()), digest)

        models = [judged(None, given)]
        if not _is_readable(models[0].found):
            return models
        own = replace(context, sink=Sink())
        cells = [cell for cell in cells_of(recipe, own, dict(given)) if cell.sample <= 1]
        models[0] = replace(models[0], found=tuple(dict.fromkeys([*models[0].found, *own.sink.sorted()])))
        models += [judged(cell, {**given, **cell.given}) for cell in cells[:most]]
        set_already = given.keys() | {name for cell in cells for name in cell.given}
        choices = [each for each in choices_of(recipe, own) if each.keys().isdisjoint(set_already)]
        for chosen in choices[: None if most is None else max(most - len(cells), 0)]:
            words = ",".join(f"{axis}={pick_text(value)}" for axis, value in chosen.items())
            models.append(replace(judged(None, {**given, **chosen}), cell=CellName(words)))
    return models


def _is_readable(found: Iterable[Diagnostic]) -> bool:
    return not any(each.code.startswith("yaml-") and each.severity is Severity.ERROR for each in found)


def _digest(bundle: Bundle) -> str:
    """Return a hash of a model's files, without the manifest, which names the recipe's text."""
    whole = hashlib.sha256()
    for name, content in sorted(bundle.files.items()):
        if name != MANIFEST:
            whole.update(f"{name}\0{len(content)}\0".encode())
            whole.update(content)
    return whole.hexdigest()


class Fixing(Struct, frozen=False):
    """Applies the fixes of the diagnostics that `look` finds in each model.

    It changes only files with these suffixes that the `door` allows.
    """

    look: Callable[[Context], list[Judged]]
    context: Context
    suffixes: tuple[str, ...] = RECIPES
    now: dict[Path, bytes] = field(default_factory=dict)
    before: dict[Path, bytes] = field(default_factory=dict)
    useless: set[Identity] = field(default_factory=set)
    at_once: int | None = None
    door: Door = ALL
    outside: dict[Path, None] = field(default_factory=dict)

    def fixed(self) -> Fixed:
        result = Fixed()
        models = self.found()
        for _ in range(_ROUNDS):
            earlier = dict(self.now)
            tried = self.carry_out(models)
            if not tried:
                break
            after = self.found()
            useless = _persisting(models, tried, after)
            if _breaks(models, tried, after):
                useless = set(map(_identity, tried)) if len(tried) == 1 else set()
                self.at_once = 1  # trying single fixes shows which of them fails
            elif not useless:
                result.fixed += tried
                models = after
                continue
            self.now = earlier
            self.useless |= useless
        result.left = _merged(models)
        result.outside = tuple(self.outside)
        result.door = self.door
        result.files = {
            path: (text, self.now[path]) for path, text in self.before.items() if self.now.get(path, text) != text
        }
        return result

    def holds(self, diagnostic: Diagnostic) -> bool:
        """Return whether the fix of a diagnostic removes its fault from every model and changes nothing else."""
        before = self.found()
        here = _by_place([diagnostic])
        if not any(_same_fault(each, here) for model in before for each in model.found):
            return False
        tried = self.carry_out([Judged(None, (diagnostic,))])
        after = self.found()
        return bool(tried) and not _breaks(before, tried, after) and not _persisting(before, tried, after)

    def found(self) -> list[Judged]:
        """Return the models for the current texts, with their diagnostics."""
        texts = {os.path.realpath(path): text for path, text in self.now.items()}
        context = replace(self.context, sink=Sink(), recipes={}, concrete={})
        with unsaved(texts):
            return self.look(context)

    def _is_full(self, edits: Mapping[Path, _Apart]) -> bool:
        return self.at_once is not None and sum(len(apart.edits) for apart in edits.values()) == self.at_once

    def carry_out(self, models: Iterable[Judged]) -> list[Diagnostic]:
        """Apply the fixes that fit and do not overlap; return their diagnostics."""
        edits: dict[Path, _Apart] = {}
        texts: dict[Path, str] = {}
        for diagnostic in chain.from_iterable(model.found for model in models):
            span = place_of(diagnostic)
            if span is None or _identity(diagnostic) in self.useless:
                continue
            path = Path(os.path.normpath(self.context.folder / span.file))
            if self._is_full(edits):
                break
            if path not in texts and self.is_own(path):
                texts[path] = _decoded(self.text(path))
            edit = edit_of(diagnostic, texts[path]) if path in texts else None
            if edit is not None and not self.door.sees(path):
                self.outside[path] = None
            elif edit is not None:
                edits.setdefault(path, _Apart()).add(edit, diagnostic)
        for path, apart in edits.items():
            mark = BOM_UTF8 if self.text(path).startswith(BOM_UTF8) else b""
            self.now[path] = mark + applied(texts[path], apart.edits).encode()
        return [diagnostic for apart in edits.values() for diagnostic in apart.edits.values()]

    def text(self, path: Path) -> bytes:
        if path not in self.now:
            self.now[path] = read_regular(path, in_force().xml_size)
        self.before.setdefault(path, self.now[path])
        return self.now[path]

    def is_own(self, path: Path) -> bool:
        """Return whether it is the user's own file, not a fetched or installed file."""
        fetching = self.context.fetching
        fetched = fetching is not None and fetching.around(path) is not None
        exists = unsaved_text(path) is not None or os.path.isfile(path)
        return path.suffix.lower() in self.suffixes and exists and not fetched


def _identity(diagnostic: Diagnostic) -> Identity:
    return (diagnostic.span.file if diagnostic.span is not None else ""), diagnostic.code, diagnostic.message


def _breaks(before: Sequence[Judged], tried: Sequence[Diagnostic], after: Sequence[Judged]) -> bool:
    """Return whether the fixes bring a fault, or change a model that did not have the faults."""
    later = {model.cell: model for model in after}
    return any(model.cell not in later or _suffers(model, tried, later[model.cell]) for model in before)


def _suffers(before: Judged, tried: Sequence[Diagnostic], after: Judged) -> bool:
    known = set(map(_identity, before.found))
    new = [each for each in after.found if _identity(each) not in known]
    if known.isdisjoint(map(_identity, tried)) and not before.has_errors:
        return bool(new) or before.digest != after.digest
    places = {_start(place_of(each)) for each in tried}
    return any(
        each.code.startswith(("yaml-", "xml-"))
        or (each.severity is Severity.ERROR and (not before.has_errors or _start(each.span) in places))
        for each in new
    )


def _start(span: Span | None) -> tuple[str, int, int] | None:
    return None if span is None else (span.file, span.line, span.column)


def _persisting(before: Sequence[Judged], tried: Sequence[Diagnostic], after: Sequence[Judged]) -> set[Identity]:
    """Return the identities of fixes whose faults still occur in a model; equal findings are counted."""
    later = {model.cell: model for model in after}
    useless: set[Identity] = set()
    places = _by_place(tried)
    for model in before:
        if model.is_cut_off:
            useless |= _unchanged(model, places, later.get(model.cell))
            continue
        found = Counter(map(_identity, model.found))
        still = Counter(map(_identity, later[model.cell].found)) if model.cell in later else found
        # Two models may report one place with different numbers in the message.
        fixed = [(each, fault) for each in model.found if (fault := _same_fault(each, places)) is not None]
        removed = Counter(_identity(each) for each, _ in fixed)
        useless |= {
            _identity(fault)
            for each, fault in fixed
            if still[_identity(each)] > found[_identity(each)] - removed[_identity(each)]
        }
    return useless


def _unchanged(before: Judged, places: _ByPlace, after: Judged | None) -> set[Identity]:
    """Return the identities of fixes whose faults are still at their places.

    Equal findings cannot be counted if there were more than the limit: fixing some of them brings others to light.
    """
    left = _by_place(before.found if after is None else after.found)
    fixed = ((each, _same_fault(each, places)) for each in before.found)
    return {
        _identity(fault) for each, fault in fixed if fault is not None and (each.code, _start(place_of(each))) in left
    }


_ByPlace = dict[tuple[str, tuple[str, int, int] | None], Diagnostic]
"""Diagnostics by their code and the place of their fix."""


def _by_place(tried: Iterable[Diagnostic]) -> _ByPlace:
    places: _ByPlace = {}
    for diagnostic in tried:
        places.setdefault((diagnostic.code, _start(place_of(diagnostic))), diagnostic)
    return places


def _same_fault(diagnostic: Diagnostic, tried: _ByPlace) -> Diagnostic | None:
    """Return the diagnostic among `tried` with the same code at the same place."""
    here = (_start(place_of(diagnostic)), _start(diagnostic.span))
    return next((tried[diagnostic.code, place] for place in here if place and (diagnostic.code, place) in tried), None)


def _merged(models: Sequence[Judged]) -> tuple[Diagnostic, ...]:
    sink = Sink()
    for model in models:
        for each in model.found:
            if model.cell is None:
                sink.add(each)
            else:
                sink.add_of_cell(model.cell, each)
    return tuple(sink.sorted())


def _decoded(text: bytes) -> str:
    """Return the text of a recipe; text that is not UTF-8 has no fixes."""
    with suppress(UnicodeDecodeError):
        return text.decode("utf-8-sig")
    return ""
