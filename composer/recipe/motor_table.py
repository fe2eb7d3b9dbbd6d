"""The table of motors in `docs/motors.md`. As a program, this module writes it there."""

from __future__ import annotations

import re
from pathlib import Path

from composer.recipe.motors import library

PAGE = Path(__file__).resolve().parents[2] / "docs" / "motors.md"
_TABLE = re.compile(r"(?<=<!-- motors -->\n).*?(?=<!-- end of motors -->)", re.DOTALL)
_ADDRESS = re.compile(r"https?://[^\s,]+[^\s,:]")


def table() -> str:
    """Return the table, with a row for each motor that comes with mjcompose."""
    lines = ["| motor | maker | torque, N·m | rated | speed, rad/s | inertia at the output, kg·m² | source |"]
    lines.append(f"|{'---|' * 7}")
    for name, motor in library().items():
        numbers = (motor.effort, motor.rated, motor.speed, motor.reflected)
        shown = ["" if each is None else f"{each:.4g}" for each in numbers]
        source = _ADDRESS.sub(lambda found: f"<{found.group()}>", motor.source)
        lines.append(f"| `{name}` | {motor.maker or ''} | {' | '.join(shown)} | {source} |")
    return "\n".join(lines) + "\n"


def with_table(page: str) -> str:
    """Return the text of the page with the current table."""
    return _TABLE.sub(lambda _: table(), page)


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
