"""From a keystroke to what an editor shows of it, and what the language server needs for that.

Milliseconds and mebibytes and not ratios to a peer: measured on a machine that has nothing else to do, or not at all.
"""

from __future__ import annotations

import gc
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from statistics import median

from bench.models import REPOSITORY
from bench.row import Row

sys.path.append(str(REPOSITORY / "tests"))  # the editor of the tests is the one that types here
from lsp.client import MARK, Editor

_ROUNDS = 40
_EDITS = 10_000
_COMPLETION = 30.0
_MEMORY = 500.0
_PARTS = (10, 50)
_TO_FEW = 3.0
_LIMITS = {"demo": 100.0, "menagerie_ur5e_2f85": 200.0}


def rows() -> Iterator[Row]:
    corpus = os.environ.get("MJCOMPOSE_CORPUS")
    robots = os.environ.get("MENAGERIE_ROOT") or (corpus and str(Path(corpus, "models")))
    environment = {**os.environ, **({"MENAGERIE_ROOT": robots} if robots else {})}
    with Editor(REPOSITORY / "recipes", environment=environment) as editor:
        names = _LIMITS if robots else ["demo"]
        for name in names:
            yield from _typed(editor, name)
    yield _of_parts()
    if Path("/proc/self/status").exists():
        with Editor(REPOSITORY / "recipes", environment=environment) as editor:
            yield _replayed(editor)
    else:
        yield Row(f"memory after {_EDITS} edits", None, None, "measured on Linux only")


def _typed(editor: Editor, name: str) -> Iterator[Row]:
    """A site is misspelled and put right again, letter by letter; at each a site is asked for."""
    text = (editor.folder / f"{name}.yaml").read_text(encoding="utf-8")
    uri = editor.open(f"{name}.yaml")
    editor.diagnostics(uri)
    head, middle, tail = text.rpartition("site: ")
    site, _, rest = tail.partition("}")
    keystrokes = []
    completions = []
    for count in range(_ROUNDS):
        written = site[: len(site) - count % 4]
        started = time.perf_counter()
        editor.change(uri, f"{head}{middle}{written}}}{rest}")
        editor.diagnostics(uri)
        keystrokes.append((time.perf_counter() - started) * 1e3)
        time.sleep(0.03)
        params, _ = editor.at(f"{head}{middle}{written}{MARK}}}{rest}", f"{name}.yaml")
        started = time.perf_counter()
        editor.ask("textDocument/completion", params)
        completions.append((time.perf_counter() - started) * 1e3)
        editor.diagnostics(uri)
    yield _row(f"keystroke to diagnostics: {name}", keystrokes, _LIMITS[name])
    yield _row(f"completion: {name}", completions[1:], _COMPLETION)


def _of_parts() -> Row:
    """The processor time of one analysis, which is what an editor waits for."""
    from mjcompose.lsp.desk import Workspace

    workspace = Workspace(Path.cwd())
    best: dict[int, float] = {}
    for count in _PARTS:
        path = Path("parts.yaml").absolute()
        analysis = None
        for number in range(8):
            text = _recipe_of_parts(count, number)
            path.write_text(text)
            gc.collect()
            started = time.process_time()
            analysis = workspace.analyze(path, text, {}, analysis)
            took = time.process_time() - started
            assert analysis.is_composed, analysis.found
            best[count] = min(best.get(count, took), took)
    workspace.close()
    few, many = (best[count] for count in _PARTS)
    note = f"{many * 1e3:.0f} ms, {few * 1e3:.0f} ms; at most 100 ms; all parts are composed each time, none is traced"
    return Row(f"a keystroke at {_PARTS[1]} parts / at {_PARTS[0]}", many / few, _TO_FEW, note)


def _recipe_of_parts(count: int, number: int) -> str:
    models = REPOSITORY / "recipes" / "models"
    lines = [f"recipe: 1\nname: parts\nbase: {models}/scenes/floor.xml\nattach:"]
    for at in range(count // 5):
        lines += [
            f"  table{at}: {{model: {models}/table/table.xml, pos: [{at}, 0, 0.{number}]}}",
            f"  arm{at}: {{model: {models}/arm6/arm6.xml, site: table{at}/mount}}",
            f"  gripper{at}: {{model: {models}/gripper2/gripper2.xml, site: arm{at}/attachment_site}}",
            f"  cube{at}: {{model: {models}/props/cube.xml, pos: [{at}, 0.2, 1]}}",
            f"  block{at}: {{model: {models}/props/cube.xml, pos: [{at}, -0.2, 1]}}",
        ]
    return "\n".join(lines) + "\n"


def _row(name: str, found: list[float], limit: float) -> Row:
    middle = median(found)
    note = f"median {middle:.0f} ms of {len(found)}, {min(found):.0f} to {max(found):.0f}; at most {limit:.0f}"
    return Row(name, middle / limit, 1.0, note)


def _replayed(editor: Editor) -> Row:
    """An hour of typing, as fast as the server takes it: the recipe is written letter by letter, again and again."""
    text = (editor.folder / "demo.yaml").read_text(encoding="utf-8")
    uri = editor.open("demo.yaml")
    for count in range(_EDITS):
        at = count % len(text)
        editor.change(uri, text[:at] if count % 50 else text)
        if count % 5 == 0:
            editor.diagnostics(uri)
    editor.change(uri, text)
    editor.diagnostics(uri)
    status = Path(f"/proc/{editor.process.pid}/status").read_text()
    peak = int(next(line for line in status.splitlines() if line.startswith("VmHWM")).split()[1]) / 1024
    note = f"{peak:.0f} MiB at most, of {_MEMORY:.0f}"
    return Row(f"memory after {_EDITS} edits", peak / _MEMORY, 1.0, note)
