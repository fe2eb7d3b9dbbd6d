"""Commands of mjcompose that an editor starts. Each runs in its own process, which ends with the server."""

from __future__ import annotations

import asyncio
import contextlib
import subprocess
import sys
from pathlib import Path

from composer.dataclass import dataclass
from composer.processes.process import Process


@dataclass(frozen=True, slots=True)
class Said:
    """The output of a command, and whether the command succeeded."""

    text: str
    ok: bool


class Errands:
    """Runs commands in a folder. A `view` runs until the same model is viewed again, or the server ends."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._views: dict[tuple[str, ...], Process] = {}

    async def run(self, verb: str, recipe: str, cell: str | None = None) -> Said:
        """Run `view`, `build` or `check` for a recipe, or for one cell of its matrix."""
        words = [verb, recipe, *(("--pick", cell) if cell is not None else ())]
        if verb == "build":
            words += ["-o", str(self.folder / "build" / f"{cell or Path(recipe).stem}.zip")]
        run = self._view if verb == "view" else self._done
        return await asyncio.get_running_loop().run_in_executor(None, run, words)

    def _done(self, words: list[str]) -> Said:
        process = self._start(words)
        out, _ = process.communicate()
        return Said(out.strip() or f"{words[0]}: done", process.returncode == 0)

    def _view(self, words: list[str]) -> Said:
        """Start `view` and return its first line of output, which is the address."""
        key = tuple(words)
        if (known := self._views.pop(key, None)) is not None:
            known.end()
        process = self._views[key] = self._start(words)
        assert process.stdout is not None
        line = process.stdout.readline().strip()
        return Said(line or "the model cannot be shown: see its diagnostics", line.startswith("http"))

    def _start(self, words: list[str]) -> Process:
        if words[0] == "build":
            (self.folder / "build").mkdir(exist_ok=True)
        return Process(
            [sys.executable, "-m", "composer", *words], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT, cwd=self.folder, encoding="utf-8", errors="replace",
        )  # fmt: skip

    def end(self) -> None:
        """Stop every `view`."""
        for process in self._views.values():
            with contextlib.suppress(OSError):
                process.end()
        self._views.clear()
