"""Peak memory of linking many copies, against the length of the text that comes out."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from bench.models import REPOSITORY, models
from bench.row import Row

_COPIES = 100
_TO_TEXT = 4.0
_STATUS = Path("/proc/self/status")


def rows() -> list[Row]:
    name = f"peak memory of {_COPIES} copies / their text"
    if not _STATUS.exists():
        return [Row(name, None, _TO_TEXT, "measured on Linux only")]
    command = [sys.executable, "-m", "bench.memory", str(models().hand)]
    answer = subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, text=True).stdout
    grown, length = map(int, answer.split())
    note = f"{grown / 2**20:.0f} MiB for {length / 2**20:.1f} MiB of text"
    return [Row(name, grown / length, _TO_TEXT, note)]


def _kibibytes(field: str) -> int:
    line = next(line for line in _STATUS.read_text().splitlines() if line.startswith(field))
    return int(line.split()[1])


def _measure(model: Path) -> None:
    """Print by how many bytes the process grew at most, and the length of the text; one copy warms it up."""
    from bench import ours

    ours.copies(model, 1)
    before = _kibibytes("VmRSS")
    text = ours.copies(model, _COPIES)
    print((_kibibytes("VmHWM") - before) * 1024, len(text))  # noqa: T201


if __name__ == "__main__":
    _measure(Path(sys.argv[1]))
