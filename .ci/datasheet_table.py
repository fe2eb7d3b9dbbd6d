"""Write the table of the data sheets that come with mjcompose into the page that is given."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from mjcompose.language.datasheets import library

_TABLE = re.compile(r"(?<=<!-- datasheets -->\n).*?(?=<!-- end of datasheets -->)", re.DOTALL)
_ADDRESS = re.compile(r"https?://[^\s,]+[^\s,:]")


def table() -> str:
    """Return the table, with a row for each motor that comes with mjcompose."""
    lines = ["| motor | maker | torque, N·m | rated | speed, rad/s | inertia at the output, kg·m² | source |"]
    lines.append(f"|{'---|' * 7}")
    for name, motor in library().items():
        numbers = (motor.effort, motor.rated, motor.speed, motor.reflected)
        shown = ["" if each is None else f"{each:.4g}" for each in numbers]
        address = _ADDRESS.search(motor.source)
        source = f"<{address.group()}>" if address else motor.source
        lines.append(f"| `{name}` | {motor.maker or ''} | {' | '.join(shown)} | {source} |")
    return "\n".join(lines) + "\n"


def with_table(page: str) -> str:
    """Return the text of the page with the current table."""
    return _TABLE.sub(lambda _: table(), page)


if __name__ == "__main__":
    page = Path(sys.argv[1])
    page.write_text(with_table(page.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
