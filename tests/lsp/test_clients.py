"""Editors differ in what they say at the start: the server answers each in its own units."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from lsp.client import Editor
from mjcompose.cli.main import main

TEXT = 'recipe: 1\nattach: {"🤖é": {model: ./none.xml, sitt: x}}\n'
WORD = TEXT.splitlines()[1].index("sitt")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "encodings", "unit"),
    [
        ("Neovim", ["utf-8", "utf-16", "utf-32"], None),
        ("Helix", ["utf-8", "utf-32", "utf-16"], None),
        ("Eglot", ["utf-32", "utf-8", "utf-16"], None),
        ("VS Code", ["utf-16"], "utf-16"),
        ("Kate and Zed", [], "utf-16"),
    ],
)
def test_columns_in_the_units_that_were_agreed_on(
    tmp_path: Path, name: str, encodings: list[str], unit: str | None
) -> None:
    with Editor(tmp_path, encodings=encodings) as editor:
        agreed = editor.capabilities.get("positionEncoding", "utf-16")
        found = editor.diagnostics(editor.open("a.yaml", TEXT))
        symbols = editor.ask("textDocument/documentSymbol", {"textDocument": {"uri": editor.uri("a.yaml")}})
    assert agreed in (encodings or ["utf-16"])
    assert unit in (None, agreed)
    (fault,) = [each for each in found if each["code"] == "unknown-key"]
    line = TEXT.splitlines()[1]
    size = {"utf-8": 1, "utf-16": 2, "utf-32": 4}[agreed]
    coded = "utf-8" if agreed == "utf-8" else f"{agreed}-le"
    assert fault["range"]["start"]["character"] == len(line[:WORD].encode(coded)) // size
    assert fault["range"]["end"]["character"] == len(line[: WORD + 4].encode(coded)) // size
    assert [each["name"] for each in symbols] == ["recipe", "attach"]


def test_a_file_that_was_never_saved(editor: Editor) -> None:
    uri = "untitled:Untitled-1.yaml"
    document = {"uri": uri, "languageId": "yaml", "version": 1, "text": "recipe: 1\nsensr: {}\n"}
    editor.tell("textDocument/didOpen", {"textDocument": document})
    (found,) = editor.wait(uri, bool)
    assert found["code"] == "unknown-key"


def test_everything_the_docs_promise_is_offered(editor: Editor) -> None:
    offered = {name for name, value in editor.capabilities.items() if value}
    assert {
        "completionProvider",
        "hoverProvider",
        "definitionProvider",
        "referencesProvider",
        "renameProvider",
        "codeActionProvider",
        "documentSymbolProvider",
        "foldingRangeProvider",
        "inlayHintProvider",
        "codeLensProvider",
        "documentFormattingProvider",
        "executeCommandProvider",
    } <= offered


def test_the_server_ends_with_its_editor(tmp_path: Path) -> None:
    editor = Editor(tmp_path)
    assert editor.process.stdin is not None
    editor.process.stdin.close()
    assert editor.process.wait(30) == 0
    editor.close()


def test_help() -> None:
    result: Any = CliRunner().invoke(main, ["lsp", "--help"])
    assert result.exit_code == 0
    assert "Language Server Protocol" in result.output


@pytest.mark.parametrize("package", ["pygls", "lsprotocol"])
def test_a_missing_extra(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    ours = ("pygls", "lsprotocol", "mjcompose.lsp.server", "mjcompose.lsp.protocol")
    for name in [name for name in sys.modules if name.startswith(ours)]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, package, None)
    result: Any = CliRunner().invoke(main, ["lsp"])
    assert result.exit_code == 2
    assert "The language server needs `mjcompose[lsp]`, which is not installed" in " ".join(result.output.split())
    assert 'pip install "mjcompose[lsp]"' in result.output
    assert "Traceback" not in result.output


def test_no_other_command_imports_it() -> None:
    code = "import sys; from mjcompose.cli import check, view; print(any(name.startswith('pygls') for name in sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == "False"
