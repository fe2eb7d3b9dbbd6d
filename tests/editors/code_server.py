"""VS Code in a browser: code-server, of npm, with Chromium. For a test where there is one, and for the film of the docs."""

from __future__ import annotations

import json
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

SETTINGS = {
    "extensions.ignoreRecommendations": True,
    "mjcompose.command": [sys.executable, "-P", "-m", "mjcompose"],
    "remote.autoForwardPorts": False,
    "telemetry.telemetryLevel": "off",
    "workbench.startupEditor": "none",
    "workbench.tips.enabled": False,
}
_OPTIONS = "--auth none --disable-workspace-trust --disable-telemetry --disable-update-check --disable-getting-started-override"
_BROWSER = "--no-sandbox --disable-quic --use-gl=angle --use-angle=swiftshader --enable-unsafe-swiftshader"


@contextmanager
def code_server(
    entry: str, home: Path, folder: Path, settings: Mapping[str, Any], packages: Sequence[Path] = ()
) -> Iterator[tuple[str, Any]]:
    """Serve a folder by the `out/node/entry.js` of a code-server, with what it keeps in `home`; gives address and browser."""
    from playwright.sync_api import sync_playwright

    # What a machine has of its own, as the path of a program, does not count among the settings of its user.
    for name in ("User", "Machine"):
        (home / "data" / name).mkdir(parents=True)
        (home / "data" / name / "settings.json").write_text(json.dumps({**SETTINGS, **settings}))
    command = ["node", entry, "--user-data-dir", str(home / "data"), "--extensions-dir", str(home / "extensions")]
    for package in packages:
        subprocess.run([*command, "--install-extension", str(package)], check=True, capture_output=True)
    port = _free_port()
    serving = subprocess.Popen(
        [*command, *_OPTIONS.split(), "--bind-addr", f"127.0.0.1:{port}", str(folder)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        _await(port)
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=_BROWSER.split())
            yield f"http://127.0.0.1:{port}/?folder={folder}", browser
            browser.close()
    finally:
        serving.terminate()
        serving.wait()


def _free_port() -> int:
    with socket.socket() as own:
        own.bind(("127.0.0.1", 0))
        return int(own.getsockname()[1])


def _await(port: int) -> None:
    for _ in range(300):
        with socket.socket() as own:
            if own.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.1)
    raise TimeoutError("code-server does not listen")
