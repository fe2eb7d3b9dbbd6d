"""Messages of an editor, and the answers of providers as messages.

pygls 2.1 ignores a frame without a valid length and everything after it, and never answers a request whose parameters
it cannot read. This module passes only messages that it can handle, and answers others with an error.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import re
import threading
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, BinaryIO

from lsprotocol import types as lsp

from mjcompose.base.codes import address
from mjcompose.base.diagnostic import Diagnostic, Severity, Span
from mjcompose.base.naming import file_name
from mjcompose.base.processes import PIPE, STDOUT, Overrun, Process, WorkFolder, own_command
from mjcompose.base.report import printable
from mjcompose.bundle.bundle import OutputError
from mjcompose.bundle.staging import check_own_place
from mjcompose.lsp import analysis
from mjcompose.text.node import TextChange

_LENGTH = b"content-length"
_MOST_LINE = 1 << 16
_MOST = 1 << 26
PARSE_ERROR = -32700
INVALID_REQUEST = -32600
INVALID_PARAMS = -32602

Structure = Callable[[bytes], object]
Answer = Callable[[Any, int, str], None]


class Frames:
    """A stream of valid frames, as `readline` and `read` of a binary file give it.

    `structure` creates the objects of a message; it raises an exception if the protocol does not have them. `answer`
    takes the id of a request or None, a code and a sentence.
    """

    def __init__(self, stream: BinaryIO, structure: Structure, answer: Answer) -> None:
        self._stream = stream
        self._structure = structure
        self._answer = answer
        self._head: list[bytes] = []
        self._body = b""
        self._is_shut = False

    def readline(self) -> bytes:
        if not self._head:
            body = self._next()
            if body is None:
                return b""
            self._body = body
            self._head = [b"Content-Length: %d\r\n" % len(body), b"\r\n"]
        return self._head.pop(0)

    def read(self, size: int) -> bytes:
        return self._body  # pygls reads as many bytes as the last head says, which is the whole body

    def _next(self) -> bytes | None:
        while (length := self._length()) is not None:
            if length > _MOST:
                self._answer(None, INVALID_REQUEST, f"a message has {length} bytes, more than {_MOST}")
                while length and (piece := self._stream.read(min(length, 1 << 20))):
                    length -= len(piece)
                continue
            body = self._stream.read(length)
            if len(body) < length:
                return None
            if self._is_valid(body):
                return body
        return None

    def _length(self) -> int | None:
        """Read the head of a frame, and return its length. Answer frames without a valid length, and skip them."""
        found: list[bytes] = []
        is_head = False
        while line := self._stream.readline(_MOST_LINE):
            # At the end of a line: the content of a frame with a wrong length runs into the head of the next one.
            name, _, value = line[max(line.lower().rfind(_LENGTH), 0) :].partition(b":")
            if name.strip().lower() == _LENGTH:
                found.append(value.strip())
            is_head = is_head or bool(line.strip())
            if line.strip() or not is_head:
                continue
            text = found[0] if len(found) == 1 else b""
            if text.isdigit() and len(text) < 16 and int(text):
                return int(text)
            shown = ", ".join(each.decode("ascii", "replace")[:40] for each in found[:3])
            wrong = f"`{shown}` is not the length of a message"
            self._answer(None, PARSE_ERROR, wrong if found else "a message has no `Content-Length`")
            found = []
            is_head = False
        return None

    def _is_valid(self, body: bytes) -> bool:
        try:
            message = json.loads(body)
        except Exception as error:  # also a RecursionError, for data that nests too deep
            self._answer(None, PARSE_ERROR, f"a message is not JSON: {str(error) or type(error).__name__}")
            return False
        number = message.get("id") if isinstance(message, dict) else None
        # JSON-RPC 2.0 also allows fractions and null, LSP does not; `true` is an int only in Python.
        if isinstance(number, bool) or not isinstance(number, int | str):
            number = None
        fault = self._fault(message, number, body)
        if fault is not None:
            self._answer(number, *fault)
        return fault is None

    def _fault(self, message: Any, number: int | str | None, body: bytes) -> tuple[int, str] | None:
        if not isinstance(message, dict) or message.get("jsonrpc") != "2.0":
            return INVALID_REQUEST, "a message is an object with `jsonrpc` 2.0"
        if "method" not in message:  # the editor's answer to a request of the server
            return None if "id" in message else (INVALID_REQUEST, "a message has neither a `method` nor an `id`")
        method = message["method"]
        if not isinstance(method, str) or ("id" in message and number is None):
            return INVALID_REQUEST, "a method must be a string, and the `id` of a request a string or an integer"
        # LSP 3.17: after `shutdown`, requests get this error, and notifications (`exit`) are still heard.
        if self._is_shut and number is not None:
            return INVALID_REQUEST, "the server is shutting down"
        self._is_shut = self._is_shut or method == "shutdown"
        try:
            self._structure(body)
        except Exception:
            return INVALID_PARAMS, f"the parameters of `{method}` do not follow the protocol"
        return None


_SEVERITIES = {
    Severity.ERROR: lsp.DiagnosticSeverity.Error,
    Severity.WARNING: lsp.DiagnosticSeverity.Warning,
    Severity.NOTE: lsp.DiagnosticSeverity.Information,
}
_K = lsp.CompletionItemKind
_KINDS = {
    "key": _K.Property,
    "element": _K.Struct,
    "word": _K.EnumMember,
    "part": _K.Module,
    "file": _K.File,
    "model": _K.Module,
    "scheme": _K.Folder,
    "parameter": _K.Variable,
    "variant": _K.Enum,
    "function": _K.Function,
    "constant": _K.Constant,
    "pattern": _K.Operator,
    "site": _K.Reference,
    "frame": _K.Reference,
    "body": _K.Struct,
    "joint": _K.Field,
    "geom": _K.Value,
    "actuator": _K.Event,
    "sensor": _K.Event,
    "default": _K.Class,
    "material": _K.Color,
    "texture": _K.Color,
}
_S = lsp.SymbolKind
_SYMBOLS = {
    "section": _S.Namespace,
    "part": _S.Module,
    "list": _S.Array,
    "value": _S.Property,
    "element": _S.Object,
}


_WORD = re.compile(r"\S+|\s")


class Converter:
    """Converts places to the units in which the editor counts.

    `lines` gives the lines of a file, and `uri` gives its address.
    """

    def __init__(
        self, encoding: str, folder: Path, lines: Callable[[Path], list[str]], uri: Callable[[Path], str]
    ) -> None:
        self.encoding = encoding
        self.folder = folder
        self._lines = lines
        self._uri = uri
        self.takes_snippets = False

    def path(self, span: Span) -> Path:
        return Path(os.path.normpath(self.folder / span.file))

    def uri(self, span: Span) -> str:
        return self._uri(self.path(span))

    def range(self, span: Span) -> lsp.Range:
        """Return a span as a range. A span without an end covers the word that begins there."""
        lines = self._lines(self.path(span)) or [""]
        line = min(max(span.line - 1, 0), len(lines) - 1)
        text = lines[line]
        start = min(span.column - 1, len(text)) if span.line - 1 == line else len(text)
        if span.end_line is None or span.end_column is None:
            word = _WORD.match(text, start)
            last = line
            end = len(text) if word is None else word.end()
        else:
            last = min(max(span.end_line - 1, line), len(lines) - 1)
            end = min(span.end_column - 1, len(lines[last]))
        return lsp.Range(
            lsp.Position(line, analysis.units(text, start, self.encoding)),
            lsp.Position(last, analysis.units(lines[last], max(end, start) if last == line else end, self.encoding)),
        )

    def column(self, lines: list[str], position: lsp.Position) -> int:
        text = lines[position.line] if position.line < len(lines) else ""
        return analysis.column_of(text, position.character, self.encoding)

    def meets(self, found: Diagnostic, path: Path, place: lsp.Range) -> bool:
        own = self.diagnostic(found, path).range
        return own.start <= place.end and place.start <= own.end

    def location(self, span: Span) -> lsp.Location:
        return lsp.Location(self.uri(span), self.range(span))

    def diagnostic(self, found: Diagnostic, path: Path) -> lsp.Diagnostic:
        """Return a diagnostic in a file. A diagnostic without a place in this file is shown on the first line."""
        span = found.span if found.span is not None and self.path(found.span) == path else None
        # LSP 3.17 has no diagnostics without a range.
        place = lsp.Range(lsp.Position(0, 0), lsp.Position(0, 0)) if span is None else self.range(span)
        notes = [(note.span, note.message) for note in (*found.notes, *found.others) if note.span is not None]
        related = [lsp.DiagnosticRelatedInformation(self.location(at), message) for at, message in notes]
        url = address(found.code)
        return lsp.Diagnostic(
            place,
            _words(found),
            _SEVERITIES[found.severity],
            found.code,
            source="mjcompose",
            related_information=related or None,
            code_description=None if url is None else lsp.CodeDescription(url),
        )

    def completion(self, found: analysis.Completion) -> lsp.CompletionList:
        return lsp.CompletionList(False, [self._item(each, found, at) for at, each in enumerate(found.items)])

    def _item(self, item: analysis.Item, found: analysis.Completion, at: int) -> lsp.CompletionItem:
        text = item.insert or item.label
        has_caret = "$0" in text and item.kind in ("key", "element")
        form = lsp.InsertTextFormat.Snippet if has_caret and self.takes_snippets else None
        text = text if not has_caret or self.takes_snippets else text.replace("$0", "")
        edit = None if found.span is None else lsp.TextEdit(self.range(found.span), text)
        # A command of VS Code; LSP itself cannot ask for the next completion.
        again = lsp.Command("complete", "editor.action.triggerSuggest") if item.again else None
        return lsp.CompletionItem(
            item.label,
            kind=_KINDS.get(item.kind, _K.Text),
            detail=item.detail or None,
            documentation=_markup(item.doc) if item.doc else None,
            sort_text=f"{at:05}",  # without it, editors sort by label
            text_edit=edit,
            filter_text=item.label,
            insert_text_mode=lsp.InsertTextMode.AsIs,  # the lines of the text have their indent
            command=again,
            insert_text_format=form,
        )

    def hover(self, found: analysis.Hover) -> lsp.Hover:
        place = None if found.span is None else self.range(found.span)
        return lsp.Hover(_markup(found.text), place)

    def edit(self, changes: Iterable[TextChange]) -> lsp.WorkspaceEdit:
        files: dict[str, list[lsp.TextEdit]] = {}
        for each in changes:
            files.setdefault(self.uri(each.span), []).append(self.text_edit(each))
        return lsp.WorkspaceEdit(changes=files)

    def text_edit(self, change: TextChange) -> lsp.TextEdit:
        return lsp.TextEdit(self.range(change.span), change.text)

    def action(self, found: analysis.Action, path: Path) -> lsp.CodeAction:
        about = None if found.diagnostic is None else [self.diagnostic(found.diagnostic, path)]
        return lsp.CodeAction(
            found.title,
            found.kind,
            about,
            is_preferred=found.is_preferred or None,
            edit=self.edit(found.changes),
        )

    def symbol(self, found: analysis.Symbol) -> lsp.DocumentSymbol:
        return lsp.DocumentSymbol(
            found.name or "?",
            _SYMBOLS.get(found.kind, _S.Property),
            self.range(found.whole),
            self.range(found.span),
            found.detail or None,
            children=[self.symbol(each) for each in found.children] or None,
        )

    def hint(self, found: analysis.Hint) -> lsp.InlayHint:
        return lsp.InlayHint(self.range(found.span).end, found.text, padding_left=True, tooltip=found.doc or None)

    def lens(self, found: analysis.Lens) -> lsp.CodeLens:
        return lsp.CodeLens(
            self.range(found.span), lsp.Command(found.title, found.command, arguments=[*found.arguments])
        )


def _markup(text: str) -> lsp.MarkupContent:
    """Return Markdown for an editor, which would fetch the pictures that a name in a model asks for."""
    return lsp.MarkupContent(lsp.MarkupKind.Markdown, printable(text).replace("![", "!\\["))


def _words(found: Diagnostic) -> str:
    notes = [note.message for note in found.listed() if note.span is None]
    help = [f"help: {found.help}"] if found.help else []
    return printable("\n".join([found.message, *notes, *help]))


_SECONDS = 3600.0
_MOST_OUTPUT = 16 << 20
_MOST_LINES = 1000
_PIECE = 1 << 16


def _drain(pipe: BinaryIO) -> None:
    """Read a pipe to its end: a program that prints more than a pipe holds would wait."""
    with contextlib.suppress(OSError, ValueError):
        while pipe.read(_PIECE):
            pass


def _text(output: bytes) -> str:
    return output.decode("utf-8", "replace").strip()


class Errands:
    """Runs commands in a folder. A `view` runs until the same model is viewed again, or the server ends."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._views: dict[tuple[str, ...], Process] = {}

    async def run(self, verb: str, recipe: str, cell: str | None = None) -> tuple[str, bool]:
        """Run `view`, `build` or `check` for a recipe or a cell of its matrix; return its output and its success."""
        words = [verb, recipe, *(("--pick", cell) if cell is not None else ())]
        if verb == "build":
            out = self.folder / "build" / f"{file_name(cell or Path(recipe).stem)}.zip"
            try:
                check_own_place(out)
            except OutputError as error:
                return f"{error.message}; {error.help}", False
            words += ["-o", str(out)]
        return await asyncio.get_running_loop().run_in_executor(None, self._run, words)

    def _run(self, words: list[str]) -> tuple[str, bool]:
        if words[0] != "view":
            with self._start(words) as process:
                try:
                    out, _ = process.finish(seconds=_SECONDS, most=_MOST_OUTPUT)
                except Overrun as overrun:
                    return f"`mjcompose {words[0]}` was ended: {overrun}", False
            return _text(out) or f"{words[0]}: done", process.returncode == 0
        known = self._views.pop(tuple(words), None)
        if known is not None:
            known.end()
        process = self._views[tuple(words)] = self._start(words)
        assert process.stdout is not None
        lines: list[str] = []
        while len(lines) < _MOST_LINES and (line := process.stdout.readline(_MOST_LINE)):
            lines.append(_text(line))
            if lines[-1].startswith("http"):  # its address; the rest is not shown
                threading.Thread(target=_drain, args=(process.stdout,), daemon=True).start()
                return lines[-1], True
        process.end()
        return "\n".join(filter(None, lines)) or "the model cannot be shown: see its diagnostics", False

    def _start(self, words: list[str]) -> Process:
        if words[0] == "build":
            (self.folder / "build").mkdir(exist_ok=True)
        return Process(
            own_command(*words),
            stdout=PIPE,
            stderr=STDOUT,
            folder=WorkFolder(self.folder, "messages name recipes from the folder of the editor"),
        )

    def end(self) -> None:
        for process in self._views.values():
            with contextlib.suppress(OSError):
                process.end()
        self._views.clear()
