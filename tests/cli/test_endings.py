"""Ctrl-C and SIGTERM end every command within a second, whatever its children do."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from cli.shell import environment

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="it finds processes in /proc")
MODEL = '<mujoco><worldbody><body name="a"><joint/><geom name="g" size="1"/></body></worldbody><keyframe><key name="k"/></keyframe></mujoco>'
RECIPE = "recipe: 1\nbase: ./model.xml\n"
CELLS = (
    RECIPE
    + 'params: {s: {default: 1}}\nedit: [{select: {geom: g}, set: {size: ["${s}"]}}]\nmatrix: {axes: {s: [1, 2, 3, 4, 5, 6, 7, 8, 9]}}\n'
)
COMMANDS = {
    "build": ["build", "a.yaml", "-o", "out"],
    "build --watch": ["build", "a.yaml", "-o", "out", "--watch"],
    "build --all": ["build", "cells.yaml", "--all", "-o", "out/{name}/", "--jobs", "2"],
    "check": ["check", "a.yaml"],
    "check --jobs": ["check", "cells.yaml", "--all", "--jobs", "2"],
    "render": ["render", "model.xml", "-o", "a.png"],
    "view": ["view", "a.yaml", "--no-open"],
    "view --html": ["view", "a.yaml", "--html", "a.html"],
    "diff": ["diff", "a.yaml", "model.xml"],
    "build --worlds": ["build", "cells.yaml", "--worlds", "w.npz", "-o", "w.zip"],
    "lsp": ["lsp"],
}


def children(parent: int) -> list[int]:
    """Every process below one."""
    found = []
    for task in Path(f"/proc/{parent}/task").glob("*/children"):
        try:
            found += [int(each) for each in task.read_text().split()]
        except OSError:
            continue
    return [each for child in found for each in (child, *children(child))]


def alive(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def hung(process: subprocess.Popen[bytes], seconds: float) -> set[int]:
    """Stop every Python that a command has started, which then hears no signal but SIGKILL, for some time."""
    found: set[int] = set()
    end = time.monotonic() + 20
    while time.monotonic() < end and process.poll() is None:
        for child in children(process.pid):
            words = Path(f"/proc/{child}/cmdline").read_bytes() if child not in found else b""
            if (b"child.py" in words or b"guard.py\0worker" in words) and children(child):  # its guard stands
                os.kill(child, signal.SIGSTOP)
                found.add(child)
                end = min(end, time.monotonic() + seconds)
        time.sleep(0.002)
    return found


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "model.xml").write_text(MODEL)
    (tmp_path / "a.yaml").write_text(RECIPE)
    (tmp_path / "cells.yaml").write_text(CELLS)
    return tmp_path


def begun(words: list[str], folder: Path) -> subprocess.Popen[bytes]:
    process = subprocess.Popen(
        [sys.executable, "-m", "mjcompose", *words],
        cwd=folder,
        env=environment() | {"MJCOMPOSE_CACHE": str(folder / "store")},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    if words == ["lsp"]:
        opened = {"uri": (folder / "a.yaml").as_uri(), "languageId": "yaml", "version": 1, "text": RECIPE}
        assert process.stdin is not None
        for number, (method, params) in enumerate(
            (
                ("initialize", {"processId": None, "rootUri": folder.as_uri(), "capabilities": {}}),
                ("initialized", {}),
                ("textDocument/didOpen", {"textDocument": opened}),
            )
        ):
            message = json.dumps({"jsonrpc": "2.0", "method": method, "params": params} | ({} if number else {"id": 1}))
            process.stdin.write(f"Content-Length: {len(message)}\r\n\r\n{message}".encode())
        process.stdin.flush()
    return process


@pytest.mark.slow
@pytest.mark.parametrize("command", COMMANDS)
def test_a_command_ends_though_its_children_hang(command: str, folder: Path) -> None:
    sent = (signal.SIGTERM, signal.SIGINT)[list(COMMANDS).index(command) % 2]
    with begun(COMMANDS[command], folder) as process:
        try:
            stuck = hung(process, 0.7)
            assert stuck, "it has no child to wait for"
            begin = time.monotonic()
            process.send_signal(sent)
            process.wait(5)
            took = time.monotonic() - begin
        finally:
            process.kill()
    assert took < 2, "a second, and some more for a busy machine"
    until_then = "view" in command or "watch" in command  # Ctrl-C is how they end
    assert process.returncode in ((0, 130) if sent == signal.SIGINT and until_then else (128 + sent,))
    for _ in range(100):
        if not any(map(alive, stuck)):
            break
        time.sleep(0.02)
    left = {each: Path(f"/proc/{each}/cmdline").read_bytes() for each in stuck if alive(each)}
    assert left == {}
