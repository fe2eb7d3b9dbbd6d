"""Peak memory of linking many copies, against the length of the text that comes out and lxml's own tree of it."""

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
    name = f"link: peak memory of {_COPIES} copies"
    if not _STATUS.exists():
        return [Row(f"{name} / their text", None, _TO_TEXT, "measured on Linux only")]
    text = Path("copies.xml").absolute()
    linking = _grown("link", text)
    holding = _grown("hold", text)
    length = text.stat().st_size
    note = f"{linking / 2**20:.0f} MiB for {length / 2**20:.1f} MiB of text"
    return [
        Row(f"{name} / their text", linking / length, _TO_TEXT, note),
        Row(f"{name} / lxml's tree of their text", linking / holding, None),
    ]


def _grown(task: str, text: Path) -> int:
    """By how many bytes a process grows at most that does nothing else."""
    command = [sys.executable, "-m", "bench.memory", task, str(models().hand), str(text)]
    return int(subprocess.run(command, cwd=REPOSITORY, check=True, capture_output=True, text=True).stdout)


def _kibibytes(field: str) -> int:
    line = next(line for line in _STATUS.read_text().splitlines() if line.startswith(field))
    return int(line.split()[1])


def _measure(task: str, model: Path, text: Path) -> int:
    """One copy warms it up, so that what is imported does not count."""
    from lxml import etree

    from bench import ours

    ours.copies(model, 1)
    before = _kibibytes("VmRSS")
    if task == "link":
        text.write_bytes(ours.copies(model, _COPIES))
    else:
        etree.parse(str(text), etree.XMLParser(remove_blank_text=True))
    return (_kibibytes("VmHWM") - before) * 1024


if __name__ == "__main__":
    sys.stdout.write(f"{_measure(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))}\n")
