"""Fix a recipe: find faults, fix them and look again, until there is nothing to fix."""

from __future__ import annotations

import os
from collections import Counter
from dataclasses import field, replace
from pathlib import Path

from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.fixing.edit import RECIPES, Edit, applied, edit_of, place_of
from composer.limits import in_force
from composer.plan.concrete import Given
from composer.reading.regular import read_regular
from composer.reading.unsaved import unsaved
from composer.stages import Request, build

_ROUNDS = 50
_OF_YAML = "yaml-"


@dataclass(slots=True)
class Fixed:
    """The result of fixing a recipe.

    `files` are the texts before and after by path; `fixed` are the fixed diagnostics, `left` the others.
    """

    files: dict[Path, tuple[bytes, bytes]] = field(default_factory=dict)
    fixed: list[Diagnostic] = field(default_factory=list)
    left: tuple[Diagnostic, ...] = ()


def fix(recipe: Path, context: Context, given: Given | None = None) -> Fixed:
    """Return the fixed texts of a recipe and of the user's own recipes that it uses; nothing is written.

    A fix that does not remove its fault is reverted. MuJoCo compiles only what the linker has to measure.
    """
    return _Fixing(recipe, context, given or {}).fixed()


class _Fixing:
    def __init__(self, recipe: Path, context: Context, given: Given) -> None:
        self.recipe, self.context, self.given = recipe, context, given
        self.now: dict[Path, bytes] = {}
        self.before: dict[Path, bytes] = {}
        self.useless: set[tuple[str, str, str]] = set()
        self.at_once: int | None = None

    def fixed(self) -> Fixed:
        result = Fixed()
        left = self.found()
        for _ in range(_ROUNDS):
            earlier = dict(self.now)
            tried = self.carry_out(left)
            if not tried:
                break
            after = self.found()
            useless = _persisting(left, tried, after)
            if _breaks(left, after):
                useless = set(map(_identity, tried)) if len(tried) == 1 else set()
                self.at_once = 1  # trying them one after the other shows which one it was
            elif not useless:
                result.fixed += tried
                left = after
                continue
            self.now = earlier
            self.useless |= useless
        result.left = tuple(left)
        result.files = {
            path: (text, self.now[path])
            for path, text in self.before.items()
            if self.now.get(path, text) != text
        }
        return result

    def found(self) -> list[Diagnostic]:
        """Return the diagnostics of the recipe in its current state."""
        texts = {os.path.realpath(path): text for path, text in self.now.items()}
        context = replace(self.context, sink=Sink(), recipes={}, concrete={})
        with unsaved(texts):
            build(Request(self.recipe, self.given, verified=False), context)
        return context.sink.sorted()

    def carry_out(self, found: list[Diagnostic]) -> list[Diagnostic]:
        """Apply the fixes that fit and do not overlap; return their diagnostics."""
        edits: dict[Path, dict[Edit, Diagnostic]] = {}
        for diagnostic in found:
            span = place_of(diagnostic)
            if span is None or _identity(diagnostic) in self.useless:
                continue
            path = Path(os.path.normpath(self.context.folder / span.file))
            if self.at_once is not None and sum(map(len, edits.values())) == self.at_once:
                break
            edit = edit_of(diagnostic, _decoded(self.text(path))) if self.is_own(path) else None
            if edit is not None and not any(_overlap(edit, each) for each in edits.setdefault(path, {})):
                edits[path][edit] = diagnostic
        for path, each in edits.items():
            if not each:
                continue
            mark = b"\xef\xbb\xbf" if self.text(path).startswith(b"\xef\xbb\xbf") else b""
            self.now[path] = mark + applied(_decoded(self.text(path)), each).encode()
        return [diagnostic for each in edits.values() for diagnostic in each.values()]

    def text(self, path: Path) -> bytes:
        if path not in self.now:
            self.now[path] = read_regular(path, in_force().recipe_size)
        self.before.setdefault(path, self.now[path])
        return self.now[path]

    def is_own(self, path: Path) -> bool:
        """Return whether it is the user's own recipe, and not one that was fetched or installed."""
        fetching = self.context.fetching
        fetched = fetching is not None and fetching.around(path) is not None
        return path.suffix.lower() in RECIPES and os.path.isfile(path) and not fetched


def _identity(diagnostic: Diagnostic) -> tuple[str, str, str]:
    """Return a finding without its place, which a fix above it moves."""
    file = diagnostic.span.file if diagnostic.span is not None else ""
    return file, diagnostic.code, diagnostic.message


def _breaks(before: list[Diagnostic], after: list[Diagnostic]) -> bool:
    """Return whether a file is no longer valid YAML: a corrected name may exist already."""
    known = set(map(_identity, before))
    return any(each.code.startswith(_OF_YAML) and _identity(each) not in known for each in after)


def _persisting(
    before: list[Diagnostic], tried: list[Diagnostic], after: list[Diagnostic]
) -> set[tuple[str, str, str]]:
    """Return the findings in `tried` that still occur; equal findings are counted."""
    made = Counter(map(_identity, tried))
    others = Counter(map(_identity, before)) - made
    now = Counter(map(_identity, after))
    return {each for each in made if now[each] > others[each]}


def _overlap(a: Edit, b: Edit) -> bool:
    return (a.start < b.end and b.start < a.end) or a.start == b.start


def _decoded(text: bytes) -> str:
    """Return the text of a recipe; text that is not UTF-8 has no fixes."""
    try:
        return text.decode("utf-8-sig")
    except UnicodeDecodeError:
        return ""
