"""Converts the answers of providers to messages. Only this module and `server` use the types of the protocol."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from pathlib import Path

from lsprotocol import types as lsp

from composer.diagnostics.diagnostic import Diagnostic, Severity
from composer.diagnostics.page import address
from composer.diagnostics.span import Span
from composer.diagnostics.text import printable
from composer.lsp.answers import Action, Change, Completion, Fold, Hint, Hover, Item, Lens, Symbol
from composer.lsp.lines import column_of, units

_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_K = lsp.CompletionItemKind
_KINDS = {
    "key": _K.Property, "word": _K.EnumMember, "part": _K.Module, "file": _K.File, "model": _K.Module,
    "scheme": _K.Folder, "parameter": _K.Variable, "variant": _K.Enum, "function": _K.Function,
    "constant": _K.Constant, "pattern": _K.Operator, "site": _K.Reference, "frame": _K.Reference, "body": _K.Struct,
    "joint": _K.Field, "geom": _K.Value, "actuator": _K.Event, "sensor": _K.Event, "default": _K.Class,
    "material": _K.Color, "texture": _K.Color,
}  # fmt: skip
_S = lsp.SymbolKind
_SYMBOLS = {
    "section": _S.Namespace,
    "part": _S.Module,
    "list": _S.Array,
    "value": _S.Property,
    "element": _S.Object,
}


class Converter:
    """Converts places to the units in which the editor counts. `lines` gives the lines of a file, `uri` its address."""

    def __init__(
        self, encoding: str, folder: Path, lines: Callable[[Path], list[str]], uri: Callable[[Path], str]
    ) -> None:
        self.encoding, self.folder, self._lines, self._uri = encoding, folder, lines, uri

    # -- places ------------------------------------------------------------------------------------------------

    def path(self, span: Span) -> Path:
        return Path(_normal(self.folder / span.file))

    def uri(self, span: Span) -> str:
        return self._uri(self.path(span))

    def range(self, span: Span) -> lsp.Range:
        """Return a span as a range. A span without an end covers the word that begins there."""
        lines = self._lines(self.path(span))
        line = min(max(span.line - 1, 0), max(len(lines) - 1, 0))
        text = lines[line] if lines else ""
        start = min(span.column - 1, len(text)) if span.line - 1 == line else len(text)
        if span.end_line is None or span.end_column is None:
            last, end = line, _word_end(text, start)
        else:
            last = min(max(span.end_line - 1, line), max(len(lines) - 1, 0))
            end = min(span.end_column - 1, len(lines[last]) if lines else 0)
        end_text = lines[last] if lines else ""
        return lsp.Range(
            lsp.Position(line, units(text, start, self.encoding)),
            lsp.Position(last, units(end_text, max(end, start) if last == line else end, self.encoding)),
        )

    def column(self, lines: list[str], position: lsp.Position) -> int:
        """Return the character of a position on its line, counted from 0."""
        text = lines[position.line] if position.line < len(lines) else ""
        return column_of(text, position.character, self.encoding)

    def meets(self, found: Diagnostic, path: Path, place: lsp.Range) -> bool:
        """Return whether a diagnostic is shown at a place of a file."""
        own = self.diagnostic(found, path).range
        return own.start <= place.end and place.start <= own.end

    def location(self, span: Span) -> lsp.Location:
        return lsp.Location(self.uri(span), self.range(span))

    # -- answers -----------------------------------------------------------------------------------------------

    def diagnostic(self, found: Diagnostic, path: Path) -> lsp.Diagnostic:
        """Return a diagnostic in a file. One without a place in this file is shown on the first line."""
        span = found.span if found.span is not None and self.path(found.span) == path else None
        place = lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0)) if span is None else self.range(span)
        related = [
            lsp.DiagnosticRelatedInformation(self.location(note.span), note.message)
            for note in (*found.notes, *found.others)
            if note.span is not None
        ]
        url = address(found.code)
        return lsp.Diagnostic(
            place, _words(found), _SEVERITIES[found.severity], found.code, source="mjcompose",
            related_information=related or None, code_description=None if url is None else lsp.CodeDescription(url),
        )  # fmt: skip

    def completion(self, found: Completion) -> lsp.CompletionList:
        return lsp.CompletionList(False, [self._item(each, found, at) for at, each in enumerate(found.items)])

    def _item(self, item: Item, found: Completion, at: int) -> lsp.CompletionItem:
        text = item.insert or item.label
        edit = None if found.span is None else lsp.TextEdit(self.range(found.span), text)
        again = lsp.Command("complete", "editor.action.triggerSuggest") if item.again else None
        return lsp.CompletionItem(
            item.label,
            kind=_KINDS.get(item.kind, _K.Text),
            detail=item.detail or None,
            documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, item.doc) if item.doc else None,
            sort_text=f"{at:05}",
            text_edit=edit,
            filter_text=item.label,
            insert_text_mode=lsp.InsertTextMode.AsIs,
            command=again,
        )

    def hover(self, found: Hover) -> lsp.Hover:
        place = None if found.span is None else self.range(found.span)
        return lsp.Hover(lsp.MarkupContent(lsp.MarkupKind.Markdown, found.text), place)

    def edit(self, changes: Iterable[Change]) -> lsp.WorkspaceEdit:
        files: dict[str, list[lsp.TextEdit]] = {}
        for each in changes:
            files.setdefault(self.uri(each.span), []).append(self.text_edit(each))
        return lsp.WorkspaceEdit(changes=files)

    def text_edit(self, change: Change) -> lsp.TextEdit:
        return lsp.TextEdit(self.range(change.span), change.text)

    def action(self, found: Action, path: Path) -> lsp.CodeAction:
        about = None if found.diagnostic is None else [self.diagnostic(found.diagnostic, path)]
        return lsp.CodeAction(
            found.title,
            found.kind,
            about,
            is_preferred=found.is_preferred or None,
            edit=self.edit(found.changes),
        )

    def symbol(self, found: Symbol) -> lsp.DocumentSymbol:
        return lsp.DocumentSymbol(
            found.name or "?", _SYMBOLS.get(found.kind, _S.Property), self.range(found.whole), self.range(found.span),
            found.detail or None, children=[self.symbol(each) for each in found.children] or None,
        )  # fmt: skip

    def hint(self, found: Hint) -> lsp.InlayHint:
        return lsp.InlayHint(
            self.range(found.span).end, found.text, padding_left=True, tooltip=found.doc or None
        )

    def lens(self, found: Lens) -> lsp.CodeLens:
        command = lsp.Command(found.title, found.command, arguments=list(found.arguments))
        return lsp.CodeLens(self.range(found.span), command)

    def fold(self, found: Fold) -> lsp.FoldingRange:
        return lsp.FoldingRange(found.first, found.last, kind=found.kind)


def _words(found: Diagnostic) -> str:
    """Return the message, the notes and the help on lines of their own, as in a terminal."""
    notes = [note.message for note in found.listed() if note.span is None]
    help = [f"help: {found.help}"] if found.help else []
    return printable("\n".join([found.message, *notes, *help]))


def _word_end(text: str, start: int) -> int:
    end = start
    while end < len(text) and not text[end].isspace():
        end += 1
    return end if end > start else min(start + 1, len(text))


def _normal(path: Path) -> str:
    return os.path.normpath(path)
