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
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any, BinaryIO, cast

from lsprotocol import types as lsp
from pygls.capabilities import get_capability
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path

from mjcompose.base.diagnostic import Diagnostic
from mjcompose.base.files import read_regular, unsaved
from mjcompose.base.version import __version__
from mjcompose.lsp import language
from mjcompose.lsp.actions import Offer, actions
from mjcompose.lsp.analysis import Analysis, Question, lines_of
from mjcompose.lsp.completion import complete
from mjcompose.lsp.desk import Desk
from mjcompose.lsp.hover import hover
from mjcompose.lsp.navigation import (
    COMMANDS,
    definition,
    folds,
    formatted,
    hints,
    hover_in_model,
    lenses,
    references,
    references_in_recipes,
    symbols,
)
from mjcompose.lsp.protocol import Converter, Errands, Frames
from mjcompose.lsp.rename import rename, renameable

_TURN = 0.001
"""How many seconds an analysis may keep Python for itself while an editor waits for an answer."""
_WATCHED = "**/*.{yaml,yml,xml,mjcf,urdf,xacro,lock}"
_TRIGGERS = [":", " ", "/", "{", "[", "$", ",", ".", "*", '"', "'"]


class Server(LanguageServer):
    """The server of one editor. It has a desk once the editor has named its folder."""

    def __init__(self) -> None:
        super().__init__("mjcompose", __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Full)
        self.desk: Desk
        self.converter: Converter
        self.errands: Errands
        self.uris: dict[Path, str] = {}

    def begin(self, folder: Path) -> None:
        encoding = str(getattr(self.workspace.position_encoding, "value", self.workspace.position_encoding) or "utf-16")
        self.converter = Converter(encoding, folder, self.lines, self.uri)
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
        found = self.desk.folder / name
        self.uris[found] = uri
        return found

    def uri(self, path: Path) -> str:
        return self.uris.get(path) or from_fs_path(str(path)) or ""

    def lines(self, path: Path) -> list[str]:
        """Return the lines of a file as the editor or the disk has it."""
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
        version = None if document is None else document.seen
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(self.uri(path), shown, version))

    def say(self, text: str) -> None:
        """Write to the log of the editor. Errors of a provider are logged and do not end the server."""
        self.window_log_message(lsp.LogMessageParams(lsp.MessageType.Error, text))

    async def analysis(self, params: Any) -> Analysis | None:
        """Return the analysis of the current text of the recipe that `params` names."""
        return await self.desk.analysed(self.path(params.text_document.uri), newest=True)

    async def question(self, params: Any, newest: bool = False, *, traced: bool = False) -> Question | None:
        """Return the question about the place in `params`, or None if no recipe is open there."""
        path = self.path(params.text_document.uri)
        analysis = await self.desk.analysed(path, newest, traced=traced)
        document = self.desk.documents.get(path)
        if analysis is None or document is None:
            return None
        lines = document.lines
        column = self.converter.column(lines, params.position)
        return Question(analysis, lines, params.position.line, column)


server = Server()
Handler = Callable[[Server, Any], Awaitable[Any]]


def _feature(name: str, options: Any = None) -> Callable[[Handler], Handler]:
    """Return a decorator for a request handler. An exception in it is logged, and the answer is empty."""

    def decorate(handler: Handler) -> Handler:
        @functools.wraps(handler)
        async def safe(own: Server, params: Any) -> Any:
            try:
                with unsaved(own.desk.texts()):
                    return await handler(own, params)
            except JsonRpcException:
                raise
            except Exception:
                own.say(traceback.format_exc())
                return None

        server.feature(name, options)(safe)
        return handler

    return decorate


# -- documents -------------------------------------------------------------------------------------------------


@server.feature(lsp.INITIALIZED)
async def initialized(own: Server, params: lsp.InitializedParams) -> None:
    root = own.workspace.root_path
    own.begin(Path(root) if root else Path.cwd())
    asyncio.get_running_loop().run_in_executor(None, language.whole)
    if get_capability(own.client_capabilities, "workspace.did_change_watched_files.dynamic_registration"):
        watchers = [lsp.FileSystemWatcher(_WATCHED)]
        options = lsp.DidChangeWatchedFilesRegistrationOptions(watchers)
        wanted = lsp.Registration("watched", lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES, options)
        own.client_register_capability(lsp.RegistrationParams([wanted]))


@server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
async def opened(own: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    document = params.text_document
    own.desk.take(own.path(document.uri), document.text, document.version)


@server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
async def changed(own: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    document = params.text_document
    own.desk.change(own.path(document.uri), params.content_changes[-1].text, document.version)


@server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
async def closed(own: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    own.desk.close(own.path(params.text_document.uri))


@server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
async def saved(own: Server, params: lsp.DidSaveTextDocumentParams) -> None:
    own.desk.changed_on_disk([own.path(params.text_document.uri)])


@server.feature(lsp.WORKSPACE_DID_CHANGE_WATCHED_FILES)
async def watched(own: Server, params: lsp.DidChangeWatchedFilesParams) -> None:
    own.desk.changed_on_disk(own.path(each.uri) for each in params.changes)


@server.feature(lsp.SHUTDOWN)
async def shut(own: Server, params: None) -> None:
    own.errands.end()
    await own.desk.shut()


# -- what is asked ---------------------------------------------------------------------------------------------


@_feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=_TRIGGERS))
async def completion(own: Server, params: lsp.CompletionParams) -> lsp.CompletionList | None:
    question = await own.question(params)
    return None if question is None else own.converter.completion(complete(question))


@_feature(lsp.TEXT_DOCUMENT_HOVER)
async def hovered(own: Server, params: lsp.HoverParams) -> lsp.Hover | None:
    path = own.path(params.text_document.uri)
    if own.desk.is_model(path):
        found = hover_in_model(path, params.position.line, await own.desk.using(path))
    else:
        question = await own.question(params, newest=True, traced=True)
        found = None if question is None else hover(question)
    return None if found is None else own.converter.hover(found)


@_feature(lsp.TEXT_DOCUMENT_DEFINITION)
async def defined(own: Server, params: lsp.DefinitionParams) -> list[lsp.Location] | None:
    question = await own.question(params, newest=True, traced=True)
    return None if question is None else [own.converter.location(each) for each in definition(question)]


@_feature(lsp.TEXT_DOCUMENT_REFERENCES)
async def referred(own: Server, params: lsp.ReferenceParams) -> list[lsp.Location] | None:
    path = own.path(params.text_document.uri)
    if own.desk.is_model(path):
        spans = references_in_recipes(path, params.position.line, await own.desk.using(path))
        return [own.converter.location(each) for each in spans]
    question = await own.question(params, newest=True, traced=True)
    if question is None:
        return None
    return [own.converter.location(each) for each in references(question, params.context.include_declaration)]


@_feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
async def may_rename(own: Server, params: lsp.PrepareRenameParams) -> lsp.Range | None:
    question = await own.question(params, newest=True)
    span = None if question is None else renameable(question)
    return None if span is None else own.converter.range(span)


@_feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
async def renamed(own: Server, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
    question = await own.question(params, newest=True)
    if question is None:
        return None
    found = rename(question, params.new_name, await own.desk.including(question.analysis.path))
    if found.refusal:
        raise JsonRpcException(found.refusal, lsp.LSPErrorCodes.RequestFailed)
    return own.converter.edit(found.changes)


@_feature(lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix, "refactor.rewrite"]))
async def acted(own: Server, params: lsp.CodeActionParams) -> list[lsp.CodeAction] | None:
    path = own.path(params.text_document.uri)
    analysis, document = await own.desk.analysed(path, True), own.desk.documents.get(path)
    if analysis is None or document is None:
        return None
    start = params.range.start
    question = Question(analysis, document.lines, start.line, own.converter.column(document.lines, start))
    here = [each for each in own.desk.found(path) if own.converter.meets(each, path, params.range)]
    return [own.converter.action(each, path) for each in actions(Offer(question, tuple(here)))]


@_feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
async def outlined(own: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol] | None:
    analysis = await own.analysis(params)
    return None if analysis is None else [own.converter.symbol(each) for each in symbols(analysis)]


@_feature(lsp.TEXT_DOCUMENT_FOLDING_RANGE)
async def folded(own: Server, params: lsp.FoldingRangeParams) -> list[lsp.FoldingRange] | None:
    document = own.desk.documents.get(own.path(params.text_document.uri))
    if document is None or document.kind != "recipe":
        return None
    return [own.converter.fold(each) for each in folds(document.lines)]


@_feature(lsp.TEXT_DOCUMENT_INLAY_HINT)
async def hinted(own: Server, params: lsp.InlayHintParams) -> list[lsp.InlayHint] | None:
    analysis = await own.analysis(params)
    if analysis is None:
        return None
    first, last = params.range.start.line + 1, params.range.end.line + 1
    return [own.converter.hint(each) for each in hints(analysis) if first <= each.span.line <= last]


@_feature(lsp.TEXT_DOCUMENT_CODE_LENS)
async def lensed(own: Server, params: lsp.CodeLensParams) -> list[lsp.CodeLens] | None:
    analysis = await own.analysis(params)
    return None if analysis is None else [own.converter.lens(each) for each in lenses(analysis)]


@_feature(lsp.TEXT_DOCUMENT_FORMATTING)
async def laid_out(own: Server, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit] | None:
    path = own.path(params.text_document.uri)
    document = own.desk.documents.get(path)
    if document is None or document.kind != "recipe":
        return None
    return [own.converter.text_edit(each) for each in formatted(document.text, str(path))]


# -- commands --------------------------------------------------------------------------------------------------


def _command(verb: str) -> None:
    @server.command(f"mjcompose.{verb}")
    async def run(own: Server, *arguments: str) -> str:
        """What the command says, as a terminal shows it; `view` goes on until the editor ends."""
        said = await own.errands.run(verb, *arguments)
        kind = lsp.MessageType.Info if said.ok else lsp.MessageType.Error
        own.window_show_message(lsp.ShowMessageParams(kind, said.text))
        return said.text


for _verb in COMMANDS:
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


def _answer(number: int | str | None, code: int, words: str) -> None:
    """Send an error. A message is written in one piece, so other threads may write too."""
    said = {"jsonrpc": "2.0", "id": number, "error": {"code": code, "message": words}}
    body = json.dumps(said).encode()
    with contextlib.suppress(BrokenPipeError):
        sys.stdout.buffer.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        sys.stdout.buffer.flush()


def _leave(number: int, frame: object) -> None:
    """End at once: threads that read from the editor or wait for MuJoCo do not hear signals."""
    with contextlib.suppress(Exception):
        server.errands.end()
        server.desk.end()
    os._exit(128 + number)
