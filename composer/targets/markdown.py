"""The table of features and targets in `docs/targets.md`. As a program, this module writes it there."""

from __future__ import annotations

import re
from pathlib import Path

from composer.targets.features import FEATURES
from composer.targets.limit import Outcome
from composer.targets.table import TARGETS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "targets.md"
_TABLE = re.compile(r"(?<=<!-- features -->\n).*?(?=<!-- end of features -->)", re.DOTALL)


def table() -> str:
    """Return the table, with a row for each feature that some target does not support."""
    lines = [f"| feature | {' | '.join(TARGETS)} |", f"|---|{'---|' * len(TARGETS)}"]
    outcomes = {
        name: {limit.feature: limit.outcome for limit in target.limits} for name, target in TARGETS.items()
    }
    for feature, words in FEATURES.items():
        cells = [outcomes[name].get(feature, Outcome.KEPT) for name in TARGETS]
        if set(cells) != {Outcome.KEPT}:
            lines.append(f"| {words} | {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"


def with_table(page: str) -> str:
    """Return the text of the page with the current table."""
    return _TABLE.sub(lambda _: table(), page)


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
