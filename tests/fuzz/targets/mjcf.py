"""MJCF: as the base of a recipe and as a part."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from fuzz.mutation import xml_changed
from fuzz.target import ROOT, Seed, Target, Tools, error_cases
from fuzz.targets.model import differs

_LARGEST = 20_000
_FOLDERS = ("recipes/models", "tests/golden", "tests/feature_cases")


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    folders = [*(ROOT / each for each in _FOLDERS), error_cases()] + ([corpus / "models"] if corpus else [])
    for folder in folders:
        for path in sorted(folder.rglob("*.xml")):
            data = path.read_bytes()
            if len(data) < _LARGEST and b"<mujoco" in data:
                yield Seed(data, path.parent)


def check(path: Path, tools: Tools) -> str | None:
    recipes = {
        "base": f"recipe: 1\nconflict: mujoco\nbase: ./{path.name}\n",
        "part": f"recipe: 1\nconflict: mujoco\nattach: {{p: {{model: ./{path.name}, pos: [1, 0, 0]}}}}\n",
    }
    return differs(path, tools, recipes)


TARGET = Target("mjcf", ".xml", _seeds, xml_changed, check)
