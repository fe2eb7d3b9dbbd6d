"""Real models: each is itself, and any two can be told apart."""

from __future__ import annotations

import json
from pathlib import Path

from composer.context import Context
from composer.diff.data import as_data
from composer.diff.diff import diff
from composer.diff.markdown import render as in_markdown
from composer.diff.text import render
from composer.engine import Session


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
