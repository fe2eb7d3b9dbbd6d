"""A recipe that a program has as data or as text: its place in memory, and its name in messages.

Such a recipe is read as an unsaved file in `base_dir`, so all stages work as for a file. Its diagnostics name the line
of the program, and the keys that lead to each place.
"""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from operator import itemgetter
from os import PathLike
from typing import Any, TypeAlias

from mjcompose.base.diagnostic import Diagnostic, Fix, Note, Span, caller, masked
from mjcompose.base.files import DATA, unsaved
from mjcompose.base.report import MjcomposeError
from mjcompose.base.sink import Sink
from mjcompose.text.dump import DataPath, in_brackets, place, plain_recipe, to_yaml
from mjcompose.text.load import load
from mjcompose.text.node import Scalar, lines_of, walk

RecipeLike: TypeAlias = "str | PathLike[str] | Mapping[str, Any]"
"""The path of a recipe, a recipe as a mapping, or a recipe as YAML of several lines."""


def opened(recipe: object, base_dir: str | PathLike[str] | None) -> str | ProgramRecipe:
    """Return the absolute path of a recipe, or the recipe itself if it is in no file.

    Raises TypeError for anything else and for values that a recipe cannot have, and MjcomposeError for a mapping that
    exceeds a limit, for YAML on one line, and for a `base_dir` that is not a folder.
    """
    if isinstance(recipe, Mapping) or (isinstance(recipe, str) and "\n" in recipe):
        if base_dir is not None and not os.path.isdir(base_dir):
            kind = "is not a folder" if os.path.exists(base_dir) else "does not exist"
            raise MjcomposeError([Diagnostic("file-not-found", f"`base_dir` `{os.fspath(base_dir)}` {kind}")])
        return ProgramRecipe(recipe, base_dir)
    if not isinstance(recipe, str | PathLike):
        kinds = "a path, a mapping, or YAML of several lines"
        raise TypeError(f"a recipe is {kinds}, got `{type(recipe).__name__}`")
    if base_dir is not None:
        raise TypeError("`base_dir` is for a mapping or a text: the paths in a file start at its folder")
    if isinstance(recipe, str) and ": " in recipe and not os.path.exists(recipe):
        help = "if it is YAML, end it with a line break"
        raise MjcomposeError([Diagnostic("file-not-found", f"the recipe `{recipe}` does not exist", help=help)])
    return os.path.abspath(recipe)


class ProgramRecipe:
    """A recipe in the memory of a program. Its `key` is equal for equal recipes."""

    def __init__(self, recipe: str | Mapping[str, Any], base_dir: str | PathLike[str] | None) -> None:
        frame = caller()
        self.name = f"<{os.path.basename(frame.f_code.co_filename).strip('<>')}:{frame.f_lineno}>"
        self.path = os.path.join(os.path.abspath(base_dir or "."), DATA)
        self._data = None if isinstance(recipe, str) else plain_recipe(recipe)
        self.key = recipe if isinstance(recipe, str) else in_brackets(self._data)

    @cached_property
    def text(self) -> str:
        return self.key if self._data is None else to_yaml(self._data)

    @contextmanager
    def readable(self) -> Iterator[None]:
        """Within the block, read the recipe at its path."""
        with unsaved({os.path.realpath(self.path): self.text.encode("utf-8", "surrogatepass")}):
            yield

    def named(self, diagnostics: Iterable[Diagnostic], shown: str) -> list[Diagnostic]:
        """Return diagnostics with this recipe's name instead of `shown`, its path in messages."""
        return [self._named(each, shown) for each in diagnostics]

    def _named(self, diagnostic: Diagnostic, shown: str) -> Diagnostic:
        def text(message: str) -> str:
            return message.replace(shown, self.name)

        def span(span: Span) -> Span:
            return replace(span, file=self.name) if span.file == shown else span

        def note(note: Note) -> Note:
            message = text(note.message)
            if note.span is None or note.span.file != shown:
                return replace(note, message=message)
            keys = self._keys.path_at(note.span)
            return Note(message if keys is None else f"{message} ({place('recipe', keys)})", span(note.span))

        notes = tuple(map(note, diagnostic.notes))
        if diagnostic.span is not None and diagnostic.span.file == shown:
            notes = (*self._place_note(diagnostic.span), *notes)
        fix = diagnostic.fix
        if fix is not None and fix.span is not None:
            fix = Fix(fix.replacement, fix.replaces, span(fix.span))
        return replace(
            diagnostic,
            message=text(diagnostic.message),
            notes=notes,
            others=tuple(map(note, diagnostic.others)),
            span=diagnostic.span and span(diagnostic.span),
            fix=fix,
        )

    def _place_note(self, span: Span) -> list[Note]:
        """Return the keys and the line of a place: nobody can open the file."""
        if span.line > len(self._lines):
            return []
        line = masked(self._lines[span.line - 1].strip())
        shown = line if len(line) <= _WIDEST else f"{line[:_WIDEST]}…"
        keys = self._keys.path_at(span)
        where = "the line is" if keys is None else f"at {place('recipe', keys)}"
        return [Note(f"{where}: {shown}")]

    @cached_property
    def _lines(self) -> list[str]:
        return lines_of(self.text)

    @cached_property
    def _keys(self) -> _Keys:
        return _Keys(self.text)


def with_value_keys(diagnostics: Iterable[Diagnostic], written: Mapping[str, str]) -> list[Diagnostic]:
    """Return diagnostics with the keys of each place in a value of a program; `written` has its text by name."""
    found: list[Diagnostic] = []
    for each in diagnostics:
        name = each.span.file.removesuffix("=") if each.span is not None else ""
        keys = _Keys(written[name]).path_at(each.span) if each.span is not None and name in written else None
        notes = (Note(f"at {place(name, keys)}"), *each.notes) if keys else each.notes
        found.append(replace(each, notes=notes))
    return found


_WIDEST = 120
"""The number of characters of a line that a note shows."""


class _Keys:
    """Finds the keys that lead to a place in a text."""

    def __init__(self, text: str) -> None:
        tree = load(text, DATA, Sink())
        self._paths: dict[tuple[int, int, int | None], DataPath] = {}
        scalars: list[tuple[int, int, Scalar, DataPath]] = []
        if tree is not None:
            for path, key, node in walk(tree):
                spans = (node.span,) if key is None else (key.span, node.span)
                for span in spans:
                    self._paths[span.line, span.column, span.end_column] = path
                if isinstance(node, Scalar):
                    scalars.append((node.span.line, node.span.column, node, path))
        scalars.sort(key=itemgetter(0, 1))
        self._starts = [scalar[:2] for scalar in scalars]
        self._scalars = [scalar[2:] for scalar in scalars]

    def path_at(self, span: Span) -> DataPath | None:
        """Return the keys of the value or the key at a place, or of the text that contains it."""
        exact = self._paths.get((span.line, span.column, span.end_column))
        index = bisect_right(self._starts, (span.line, span.column)) - 1
        if exact is not None or index < 0:
            return exact
        scalar, path = self._scalars[index]
        is_in_line = span.line == scalar.span.line and span.column <= (scalar.span.end_column or 0)
        last_line = scalar.span.line + scalar.text.count("\n") + 1
        is_in_block = scalar.block is not None and scalar.span.line < span.line <= last_line
        return path if is_in_line or is_in_block else None
