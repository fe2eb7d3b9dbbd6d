"""The programs of docs/contributing/upstream.md print what the page shows, where `mujoco[sysid]` is installed."""

from __future__ import annotations

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import mujoco
import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs" / "contributing" / "upstream.md"
REPORT = re.compile(r"^## (.+?)\n.*?```python\n(.*?)^```\n\n```text\n(.*?)^```", re.MULTILINE | re.DOTALL)
REPORTS = REPORT.findall(PAGE.read_text(encoding="utf-8"))
NEEDS = ("colorama", "plotly", "scipy", "tabulate", "matplotlib", "jinja2", "yaml", "imageio")


def test_there_are_five() -> None:
    assert len(REPORTS) == 5


@pytest.mark.slow
@pytest.mark.skipif(mujoco.__version__ != "4.0.0", reason="the page is about MuJoCo 4.0.0")
@pytest.mark.skipif(not all(map(find_spec, NEEDS)), reason="mujoco[sysid] is not installed")
@pytest.mark.parametrize(("title", "program", "expected"), REPORTS, ids=[title for title, _, _ in REPORTS])
def test_a_report_is_true(title: str, program: str, expected: str) -> None:
    words = [sys.executable, "-W", "ignore", "-c", program]
    done = subprocess.run(words, capture_output=True, text=True, timeout=300, check=False)
    assert done.stdout == expected, done.stderr
