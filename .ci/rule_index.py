"""Write the index of the linter's rules into the folder that is given."""

from __future__ import annotations

import sys
from pathlib import Path

from mjcompose.lint.rule import FAMILIES, rules

_MEANING = {
    "dead": "elements that nothing uses",
    "ranges": "limits and values that do not fit together",
    "order": "the order of joints, actuators and keyframes",
    "physics": "masses, inertias, gains and damping",
    "contact": "missing and unwanted collisions",
    "units": "values that look like another unit",
    "names": "elements that programs cannot address",
    "portable": "elements that other programs or versions of MuJoCo read otherwise",
    "files": "assets and licenses",
}
_INTRODUCTION = """\
# Rules of the linter

`mjcompose lint` runs the rules that are marked; select the others with `--select`.
The [guide](../how-to/lint.md) shows how.
"""


def index() -> str:
    lines = [_INTRODUCTION]
    for family in FAMILIES:
        lines += [f"## {family}\n\nRules about {_MEANING[family]}.\n", "| rule | runs | finds |", "|---|---|---|"]
        for each in rules().values():
            if each.family == family:
                lines.append(f"| [{each.code}]({each.code}.md) | {'yes' if each.usual else ''} | {each.summary} |")
        lines.append("")
    return "\n".join(lines)


if __name__ == "__main__":
    Path(sys.argv[1], "index.md").write_text(index(), encoding="utf-8")
