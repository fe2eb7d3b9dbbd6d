"""The server: requests of an editor are passed to the providers, over standard input and output."""

from __future__ import annotations

import asyncio
import contextlib
import functools
import json
import os
import signal
import sys
import traceback
from collections.abc import Awaitable, Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO, cast

from lsprotocol import types as lsp
from pygls.capabilities import get_capability
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path

from mjcompose.base import __version__
from mjcompose.base.diagnostic import Diagnostic, Span
from mjcompose.base.files import read_regular, unsaved
from mjcompose.lsp import language, mjcf, navigation
from mjcompose.lsp.actions import Offer, actions
from mjcompose.lsp.analysis import Analysis, Question, shown
from mjcompose.lsp.completion import complete
from mjcompose.lsp.desk import Desk, OpenFile
from mjcompose.lsp.hover import hover
from mjcompose.lsp.markup import ModelAnalysis, ModelQuestion
from mjcompose.lsp.mjcf import RenameRefused
from mjcompose.lsp.protocol import Converter, Errands, Frames
from mjcompose.lsp.rename import rename, renameable
from mjcompose.text.node import lines_of

_TURN = 0.001  # how many seconds an analysis may keep Python for itself while an editor waits for an answer
_WATCHED = "**/*.{yaml,yml,xml,mjcf,urdf,xacro,lock}"
_TRIGGERS = [":", " ", "/", "{", "[", "$", ",", ".", "*", '"', "'", "<"]


class EditorServer(LanguageServer):
    """The server of one editor; its desk exists once the editor has named its folder."""

    def __init__(self) -> None:
        super().__init__("mjcompose", __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Full)
        self.desk: Desk
        self.converter: Converter
        self.errands: Errands
        self.uris: dict[Path, str] = {}

    def begin(self, folder: Path) -> None:
        # LSP 3.17 counts columns in UTF-16 code units unless the editor offers another unit; Python counts code points.
        encoding = str(getattr(self.workspace.position_encoding, "value", self.workspace.position_encoding) or "utf-16")
        self.converter = Converter(encoding, folder, self.lines, self.uri)
        support = get_capability(self.client_capabilities, "text_document.completion.completion_item.snippet_support")
        self.converter.takes_snippets = bool(support)
        self.desk = Desk(folder, self.publish, self.say)
        self.errands = Errands(folder)

    def path(self, uri: str) -> Path:
        """Return the file of an address. A document without a file gets a path in the folder of the workspace."""
        path = to_fs_path(uri) if uri.startswith("file:") else None
        name = (path or uri.rpartition(":")[2].strip("/")).replace("\0", "?")
        try:
            os.fsencode(name)
        except UnicodeEncodeError:  # no file can be called that
            name = name.encode("ascii", "replace").decode()
        file = self.desk.folder / name
        self.uris[file] = uri
        return file

    def uri(self, path: Path) -> str:
        return self.uris.get(path) or from_fs_path(str(path)) or ""

    def lines(self, path: Path) -> list[str]:
        document = self.desk.documents.get(path)
        if document is not None:
            return document.lines
        try:
            return lines_of(read_regular(path).decode("utf-8-sig", "replace"))
        except (OSError, ValueError):
            return []

    def publish(self, path: Path, found: list[Diagnostic]) -> None:
        shown = [self.converter.diagnostic(each, path) for each in found]
        document = self.desk.documents.get(path)
        version = document.seen if document is not None else None
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(self.uri(path), shown, version))

    def say(self, text: str) -> None:
        """Write to the log of the editor. Errors of a provider are logged and do not end the server."""
        self.window_log_message(lsp.LogMessageParams(lsp.MessageType.Error, text))

    def document(self, params: Any) -> OpenFile:
        """Return the open recipe or model that `params` names. Raises NotOpen."""
        document = self.desk.documents.get(self.path(params.text_document.uri))
        if document is None or not document.kind:
            raise NotOpen
        return document

    async def analysis(self, params: Any, newest: bool = True, *, traced: bool = False) -> Analysis:
        """Return the analysis of the recipe that `params` names. Raises NotOpen."""
        analysis = await self.desk.analyzed(self.path(params.text_document.uri), newest, traced=traced)
        if analysis is None:
            raise NotOpen
        return analysis

    async def question(
        self, params: Any, newest: bool = True, *, traced: bool = False, position: lsp.Position | None = None
    ) -> Question:
        """Return the question about a position in a recipe, or about the position in `params`. Raises NotOpen."""
        analysis = await self.analysis(params, newest, traced=traced)
        lines = self.document(params).lines
        at = position or params.position
        if isinstance(analysis, ModelAnalysis):
            return ModelQuestion(analysis, lines, at.line, column=self.converter.column(lines, at))
        return Question(analysis, lines, at.line, column=self.converter.column(lines, at))

    def locations(self, spans: Iterable[Span]) -> list[lsp.Location]:
        return [self.converter.location(span) for span in spans]


class NotOpen(Exception):
    """The editor names no open recipe: the answer is empty."""


server = EditorServer()
Handler = Callable[[EditorServer, Any], Awaitable[Any]]


def _feature(name: str, options: Any = None) -> Callable[[Handler], Handler]:
    """Return a decorator for a request handler. An exception in it is logged, and the answer is empty."""

    def decorate(handler: Handler) -> Handler:
        @functools.wraps(handler)
        async def safe(own: EditorServer, params: Any) -> Any:
            try:
                with unsaved(own.desk.texts()):
                    return await handler(own, params)
            except JsonRpcException:
                raise
            except NotOpen:
                return None
            except Exception:
                own.say(traceback.format_exc())
                return None

        server.feature(name, options)(safe)
        return handler

    return decorate


@server.feature(lsp.INITIALIZED)
async def initialized(own: EditorServer, params: lsp.InitializedParams) -> None:
    root = own.workspace.root_path
    own.begin(Path(root) if root else Path.cwd())
    asyncio.get_running_loop().run_in_executor(None, language.whole)
    # LSP 3.17 has no static capability for changes of files on disk: the server has to register for them.
    if get_capability(own.client_capabilities, "workspace.did_change_watched_files.dynamic_registration"):
        watchers = [lsp.FileSystemWatcher(_WATCHED)]
        options = lsp.DidChangeWatchedFilesRegistrationOptions(watchers)
        wanted = lsp.Registration("watched", lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
        own.client_register_capability(lsp.RegistrationParams([wanted]))


@server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
async def opened(own: EditorServer, params: lsp.DidOpenTextDocumentParams) -> None:
    document = params.text_document
    own.desk.take(own.path(document.uri), document.text, document.version)


@server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
async def changed(own: EditorServer, params: lsp.DidChangeTextDocumentParams) -> None:
    document = params.text_document
    # With `TextDocumentSyncKind.Full` each change is the whole text, so the last one is the current text.
    own.desk.change(own.path(document.uri), params.content_changes[-1].text, document.version)


@server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
async def closed(own: EditorServer, params: lsp.DidCloseTextDocumentParams) -> None:
    own.desk.close(own.path(params.text_document.uri))


@server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
async def saved(own: EditorServer, params: lsp.DidSaveTextDocumentParams) -> None:
    own.desk.changed_on_disk([own.path(params.text_document.uri)])


@server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
async def watched(own: EditorServer, params: lsp.DidChangeWatchedFilesParams) -> None:
    own.desk.changed_on_disk(own.path(each.uri) for each in params.changes)


@server.feature(lsp.SHUTDOWN)
async def shut(own: EditorServer, params: None) -> None:
    own.errands.end()
    await own.desk.shut()


@_feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=_TRIGGERS))
async def completion(own: EditorServer, params: lsp.CompletionParams) -> lsp.CompletionList:
    return own.converter.completion(complete(await own.question(params, newest=False)))


@_feature(lsp.TEXT_DOCUMENT_HOVER)
async def hovered(own: EditorServer, params: lsp.HoverParams) -> lsp.Hover | None:
    path = own.path(params.text_document.uri)
    found = hover(await own.question(params, traced=True))
    if own.desk.is_model(path):
        composed = navigation.hover_in_model(path, params.position.line, await own.desk.using(path))
        if found is not None and composed is not None:
            found = replace(found, text=f"{found.text}\n\n---\n\n{composed.text}")
        found = found or composed
    return None if found is None else own.converter.hover(found)


@_feature(lsp.TEXT_DOCUMENT_DEFINITION)
async def defined(own: EditorServer, params: lsp.DefinitionParams) -> list[lsp.Location]:
    return own.locations(navigation.definition(await own.question(params, traced=True)))


@_feature(lsp.TEXT_DOCUMENT_REFERENCES)
async def referred(own: EditorServer, params: lsp.ReferenceParams) -> list[lsp.Location]:
    path = own.path(params.text_document.uri)
    question = await own.question(params, traced=True)
    is_model = own.desk.is_model(path)
    models = await own.desk.models_including(path) if is_model else []
    found = navigation.references(question, params.context.include_declaration, models)
    if is_model:
        for each in await own.desk.using(path):
            elements = navigation.elements_at(path, params.position.line, each)
            found += (span for known in elements for span in navigation.uses_of(known, each))
    return own.locations(dict.fromkeys(found))


@_feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
async def may_rename(own: EditorServer, params: lsp.PrepareRenameParams) -> lsp.Range | None:
    span = renameable(await own.question(params))
    return None if span is None else own.converter.range(span)


@_feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
async def renamed(own: EditorServer, params: lsp.RenameParams) -> lsp.WorkspaceEdit:
    question = await own.question(params)
    try:
        path = question.analysis.path
        models = await own.desk.models_including(path) if own.desk.is_model(path) else []
        changes = rename(question, params.new_name, await own.desk.including(path), models=models)
    except RenameRefused as refused:
        raise JsonRpcException(str(refused), lsp.LSPErrorCodes.RequestFailed) from None
    return own.converter.edit(changes)


@_feature(lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix, "refactor.rewrite"]))
async def acted(own: EditorServer, params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
    path = own.path(params.text_document.uri)
    question = await own.question(params, position=params.range.start)
    here = [each for each in own.desk.found(path) if own.converter.meets(each, path, params.range)]
    holding = await own.desk.holding(path, here)
    return [own.converter.action(each, path) for each in actions(Offer(question, tuple(holding)))]


@_feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
async def outlined(own: EditorServer, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
    return [own.converter.symbol(each) for each in navigation.symbols(await own.analysis(params))]


@_feature(lsp.TEXT_DOCUMENT_FOLDING_RANGE)
async def folded(own: EditorServer, params: lsp.FoldingRangeParams) -> list[lsp.FoldingRange]:
    found = navigation.folds(own.document(params).lines)
    return [lsp.FoldingRange(each.first, each.last, kind=each.kind) for each in found]


@_feature(lsp.TEXT_DOCUMENT_INLAY_HINT)
async def hinted(own: EditorServer, params: lsp.InlayHintParams) -> list[lsp.InlayHint]:
    first = params.range.start.line + 1
    last = params.range.end.line + 1
    found = navigation.hints(await own.analysis(params))
    return [own.converter.hint(each) for each in found if first <= each.span.line <= last]


@_feature(lsp.TEXT_DOCUMENT_CODE_LENS)
async def lensed(own: EditorServer, params: lsp.CodeLensParams) -> list[lsp.CodeLens]:
    return [own.converter.lens(each) for each in navigation.lenses(await own.analysis(params))]


@_feature(lsp.TEXT_DOCUMENT_DOCUMENT_COLOR)
async def colored(own: EditorServer, params: lsp.DocumentColorParams) -> list[lsp.ColorInformation]:
    document = own.document(params)
    if document.kind != "model":
        return []
    found = mjcf.colors("\n".join(document.lines), shown(document.path, own.desk.folder))
    return [lsp.ColorInformation(own.converter.range(span), lsp.Color(*color)) for span, color in found]


@_feature(lsp.TEXT_DOCUMENT_COLOR_PRESENTATION)
async def presented(own: EditorServer, params: lsp.ColorPresentationParams) -> list[lsp.ColorPresentation]:
    """Return a color as MJCF writes it, with an opacity if the old or the new color has one."""
    lines = own.document(params).lines
    place = params.range
    color = params.color
    start, end = (own.converter.column(lines, each) for each in (place.start, place.end))
    has_four = len(lines[place.start.line][start:end].split()) == 4 or color.alpha < 1
    numbers = [color.red, color.green, color.blue, *([color.alpha] if has_four else [])]
    text = " ".join(f"{each:.4g}" for each in numbers)
    return [lsp.ColorPresentation(text, lsp.TextEdit(place, text))]


@_feature(lsp.TEXT_DOCUMENT_FORMATTING)
async def laid_out(own: EditorServer, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
    document = own.document(params)
    return [own.converter.text_edit(each) for each in navigation.formatted(document.text, str(document.path))]


def _command(verb: str) -> None:
    @server.command(f"mjcompose.{verb}")
    async def run(own: EditorServer, *arguments: str) -> str:
        """Return the output of the command, as in a terminal; `view` runs until the editor ends."""
        text, ok = await own.errands.run(verb, *arguments)
        own.window_show_message(lsp.ShowMessageParams(lsp.MessageType.Info if ok else lsp.MessageType.Error, text))
        return text


for _verb in navigation.COMMANDS:
    _command(_verb)


def serve() -> None:
    """Serve one editor until it disconnects, or a signal ends the process."""
    sys.setswitchinterval(_TURN)
    for number in (signal.SIGTERM, signal.SIGINT):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _leave)
    server.start_io(cast(BinaryIO, Frames(sys.stdin.buffer, _structured, _answer)))


def _structured(body: bytes) -> object:
    return json.loads(body, object_hook=server.protocol.structure_message)


def _answer(number: int | str | None, code: int, message: str) -> None:
    """Send an error in one piece, because other threads write too."""
    body = json.dumps({"jsonrpc": "2.0", "id": number, "error": {"code": code, "message": message}}).encode()
    with contextlib.suppress(BrokenPipeError):
        sys.stdout.buffer.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        sys.stdout.buffer.flush()


def _leave(number: int, frame: object) -> None:
    """End at once: threads that read from the editor or wait for MuJoCo do not receive signals."""
    with contextlib.suppress(Exception):
        server.errands.end()
        server.desk.end()
    os._exit(128 + number)
