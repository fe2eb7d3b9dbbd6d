"""Editors of the terminal with their own clients, against the real server."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
RECIPES = HERE.parents[1] / "recipes"
FLAGS = {
    "nvim": ["--headless", "-u", "NONE", "demo.yaml", "-c", f"luafile {HERE / 'neovim.lua'}"],
    "emacs": ["--batch", "-l", str(HERE / "emacs.el")],
}

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("editor", FLAGS)
def test_an_editor_shows_faults_and_names_and_goes_to_lines(editor: str, tmp_path: Path) -> None:
    pytest.importorskip("pygls")
    if shutil.which(editor) is None:
        pytest.skip(f"there is no {editor}")
    shutil.copytree(RECIPES / "models", tmp_path / "models")
    written = (RECIPES / "demo.yaml").read_text(encoding="utf-8")
    text = written.replace("site: arm/attachment_site\n", "site: arm/attachment_sit\n", 1)
    (tmp_path / "demo.yaml").write_text(text, encoding="utf-8")
    found = _found(editor, tmp_path)

    line = text.split("\n").index("    site: arm/attachment_sit")
    assert found["fault"][:2] == [line, 10] and "`arm/attachment_sit`" in found["fault"][2]
    assert "arm/attachment_site" in found["completion"]
    file, at = found["definition"]
    model = tmp_path / "models" / "table" / "table.xml"
    assert file.endswith("models/table/table.xml")
    assert '<site name="mount"' in model.read_text(encoding="utf-8").split("\n")[at]
    if editor == "nvim":
        assert found["actions"] == ["did you mean `site: arm/attachment_site`?"]
        assert found["hover"].startswith("**site `table/mount`**") and found["ended"]


def _found(editor: str, folder: Path) -> Any:
    """What a program in the editor writes down."""
    out = folder / "found.json"
    command = json.dumps([sys.executable, "-P", "-m", "mjcompose", "lsp"])
    environment = {"COMMAND": command, "FOUND": str(out), "RECIPE": str(folder / "demo.yaml"), "HOME": str(folder)}
    ran = subprocess.run(
        [editor, *FLAGS[editor]],
        cwd=folder,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    if editor == "emacs" and "Cannot open load file" in ran.stderr and "eglot" in ran.stderr:
        pytest.skip("this Emacs has no Eglot")
    assert out.exists(), ran.stdout + ran.stderr
    return json.loads(out.read_text(encoding="utf-8"))
