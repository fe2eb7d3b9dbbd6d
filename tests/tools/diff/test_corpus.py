"""Real models: each is itself, and any two can be told apart."""

from __future__ import annotations

import json
from pathlib import Path

from mjcompose.contrast.text import as_data, render, render_markdown as in_markdown
from mjcompose.mujoco.engine import Session
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff


def test_each_is_itself_and_no_other(menagerie_root: Path) -> None:
    files = [
        str(menagerie_root / "universal_robots_ur5e" / "ur5e.xml"),
        str(menagerie_root / "robotiq_2f85" / "2f85.xml"),
    ]
    with Session() as session:
        for first in files:
            for second in files:
                found = diff(first, second, Context(), session)
                assert found is not None
                assert found.same == (first == second)
                assert render(found) and in_markdown(found) and json.dumps(as_data(found))
