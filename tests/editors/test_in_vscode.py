"""The extension in VS Code itself, as code-server runs it.

MJCOMPOSE_CODE_SERVER names the `out/node/entry.js` of one, of npm. With a VS Code on the machine `npm run test:vscode`
in editors/vscode runs the same suite.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from urllib.parse import quote

import pytest
from editors.code_server import code_server

ROOT = Path(__file__).resolve().parents[2]
EXTENSION = ROOT / "editors" / "vscode"
ENTRY = os.environ.get("MJCOMPOSE_CODE_SERVER")


@pytest.mark.slow
@pytest.mark.skipif(ENTRY is None, reason="MJCOMPOSE_CODE_SERVER names no code-server")
def test_the_suite_passes_in_vscode(tmp_path: Path) -> None:
    if not (EXTENSION / "node_modules").is_dir():
        pytest.skip("the extension's tests are not built: `npm ci` in editors/vscode")
    subprocess.run(["node", "build.mjs", "--tests"], cwd=EXTENSION, check=True)
    folder = tmp_path / "lab"
    shutil.copytree(ROOT / "recipes", folder)
    with code_server(str(ENTRY), tmp_path, folder, {}) as (address, browser):
        host = address.split("/")[2]
        remote = f"vscode-remote://{host}{EXTENSION}"
        payload = [["extensionDevelopmentPath", remote], ["extensionTestsPath", f"{remote}/build/vscode/suite.js"]]
        said: list[str] = []
        page = browser.new_page()
        page.on("console", lambda message: said.append(message.text))
        page.goto(f"{address}&payload={quote(json.dumps(payload))}")
        for _ in range(1200):
            if any("suite: " in line for line in said):
                break
            page.wait_for_timeout(100)
    (end,) = [line for line in said if "suite: " in line] or ["nothing: " + "\n".join(said[-20:])]
    assert "suite: 0 failed of " in end, "\n".join([end, *(line for line in said if "not ok: " in line)])
