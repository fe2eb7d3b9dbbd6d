"""Write the pages of the rules: `python -m mjcompose.build.lint.pages docs/rules`."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

from mjcompose.build.lint.rule import FAMILIES, Rule, rules

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


def pages() -> dict[str, str]:
    """Return the text of each page by file name, with an index."""
    every = rules()
    index = [_INTRODUCTION]
    for family in FAMILIES:
        index += [
            f"## {family}",
            "",
            f"Rules about {_MEANING[family]}.",
            "",
            "| rule | runs | finds |",
            "|---|---|---|",
        ]
        index += [_row(each) for each in every.values() if each.family == family]
        index.append("")
    texts = {"index.md": "\n".join(index)}
    return texts | {f"{code}.md": f"{_page(each)}\n" for code, each in every.items()}


def _row(each: Rule) -> str:
    return f"| [{each.code}]({each.code}.md) | {'yes' if each.usual else ''} | {each.summary} |"


def _page(each: Rule) -> str:
    lines = [f"# {each.code}", "", each.page]
    if each.in_mujoco:
        lines += ["", "MuJoCo compiles the model for this rule."]
    lines += _sources(each.profiles)
    return "\n".join(lines)


def _sources(profiles: Mapping[str, str]) -> list[str]:
    return ["", *(f"Profile `{name}`: {source}" for name, source in profiles.items())] if profiles else []


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    wanted = pages()
    for old in folder.glob("*.md"):
        if old.name not in wanted:
            old.unlink()
    for name, text in wanted.items():
        (folder / name).write_text(text, encoding="utf-8")
