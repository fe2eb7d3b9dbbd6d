"""One case, in a folder of its own."""

from __future__ import annotations

import shutil
import tempfile
import time
import traceback
from pathlib import Path

from fuzz.target import Seed, Target, Tools

SECONDS = 20
"""What a case may take."""


def wrong_with(target: Target, data: bytes, beside: Path | None, tools: Tools) -> str | None:
    """What is wrong with a case, beginning with words that name the kind of it; None where nothing is."""
    with tempfile.TemporaryDirectory(prefix="mjcompose-fuzz-", ignore_cleanup_errors=True) as name:
        folder = Path(name, "case")
        if (near := beside or target.beside) is None:
            folder.mkdir()
        else:
            shutil.copytree(near, folder, symlinks=True)
        case = folder / f"case{target.suffix}"
        case.write_bytes(data)
        start = time.monotonic()
        try:
            wrong = target.check(case, tools)
        except (KeyboardInterrupt, SystemExit):
            raise
        except BaseException as error:  # whatever it is, it is a finding
            return f"{_place(error)}\n{traceback.format_exc()}"
        seconds = time.monotonic() - start
        return f"slow: {seconds:.0f} s" if wrong is None and seconds > SECONDS else wrong


def _place(error: BaseException) -> str:
    """The exception, and the innermost line of the project that it came through."""
    frames = [each for each in traceback.extract_tb(error.__traceback__) if "/composer/" in each.filename]
    where = f"-{Path(frames[-1].filename).name}-{frames[-1].lineno}" if frames else ""
    return f"{type(error).__name__}{where}"


def seeds_of(target: Target, corpus: Path | None, largest: int = 4 << 20) -> list[Seed]:
    """The seeds of a target whose folders are small enough to be copied for every case."""
    found = list(target.seeds(corpus))
    sizes: dict[Path, int] = {}
    for each in found:
        if each.beside is not None and each.beside not in sizes:
            files = (file for file in each.beside.rglob("*") if file.is_file())
            sizes[each.beside] = sum(file.stat().st_size for file in files)
    return [each for each in found if each.beside is None or sizes[each.beside] <= largest]
