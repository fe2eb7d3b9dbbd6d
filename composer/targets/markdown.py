"""The tables in `docs/targets.md`. As a program, this module writes them there."""

from __future__ import annotations

import json
import re
from functools import partial
from pathlib import Path

from composer.targets.features import COMPARED, FEATURES
from composer.targets.limit import Outcome
from composer.targets.table import TARGETS

_ROOT = Path(__file__).resolve().parents[2]
PAGE = _ROOT / "docs" / "targets.md"
READ_BACK = _ROOT / "tests" / "targets" / "read_back.json"
"""What the programs have read, by `tests/targets/read_back.py`."""


def features() -> str:
    """Return the table with a row for each feature that some target does not support. Other cells are empty."""
    lines = [f"| feature | {' | '.join(TARGETS)} |", f"|---|{'---|' * len(TARGETS)}"]
    outcomes = {
        name: {limit.feature: limit.outcome for limit in target.limits} for name, target in TARGETS.items()
    }
    for feature, words in FEATURES.items():
        cells = [outcomes[name].get(feature, Outcome.KEPT) for name in TARGETS]
        if set(cells) != {Outcome.KEPT}:
            lines.append(
                f"| {words} | {' | '.join('' if each == Outcome.KEPT else each for each in cells)} |"
            )
    return "\n".join(lines) + "\n"


def read_back() -> str:
    """Return the table of what was compared."""
    found = json.loads(READ_BACK.read_text(encoding="utf-8"))
    lines = [f"| compared | {' | '.join(found)} |", f"|---|{'---|' * len(found)}"]
    lines.append(f"| version | {' | '.join(each['version'] for each in found.values())} |")
    for feature, words in COMPARED.items():
        lines.append(f"| {words} | {' | '.join(each.get(feature, '') for each in found.values())} |")
    return "\n".join(lines) + "\n"


def with_tables(page: str) -> str:
    """Return the text of the page with the current tables."""
    for name, table in (("features", features()), ("read back", read_back())):
        inside = re.compile(rf"(?<=<!-- {name} -->\n).*?(?=<!-- end of {name} -->)", re.DOTALL)
        page = inside.sub(partial(_instead, table), page)
    return page


def _instead(table: str, _: re.Match[str]) -> str:
    return table


if __name__ == "__main__":
    PAGE.write_text(with_tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
