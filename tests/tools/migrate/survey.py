"""Makes `composer/mjcompose/tree/history.json`: which elements and attributes each MuJoCo since 3.0 has that not all have.

`python tests/tools/migrate/survey.py FOLDER`, where FOLDER has one environment for each version: `FOLDER/3.0.0/bin/python`, or
a folder of packages (`pip install --target FOLDER/3.0.0 mujoco==3.0.0`). Each is asked for the schema that it prints. To add a
new version, the last two are enough.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT))

from mjcompose.tree.history import RELEASED  # noqa: E402

OUT = ROOT / "composer" / "mjcompose" / "tree" / "history.json"
ASK = "import mujoco; print(mujoco.mj_printSchema(False, True))"
_LINE = re.compile(r"^( *)(\S+) \((.)\)\s*(.*)$")
_LEVEL = 3
_COLUMN = 20
# The schema does not print what stands for its own content; these are the words of MuJoCo's changelog.
META = {"frame": ["3.1.0", None], "replicate": ["3.1.5", None]}

Schema = dict[str, set[str]]


def schema(text: str) -> Schema:
    """The attributes of each element by its path: without the root, and with one `body` for all bodies."""
    found: Schema = {}
    above: list[str] = []
    here: set[str] = set()
    for line in text.splitlines():
        match = _LINE.match(line)
        attributes = line
        if match and not (found and len(match[1]) >= _COLUMN):
            above = [*above[: len(match[1]) // _LEVEL], match[2]]
            path = "/".join(above).removeprefix("mujoco/").replace("(world)body", "body")
            here = found.setdefault(path, set())
            attributes = match[4]
        here.update(attributes.split())
    return found


def history(schemas: dict[str, Schema]) -> dict[str, dict[str, list[str | None]]]:
    """First and last version of what is not in all versions, as `element` or `element@attribute`."""
    versions = list(schemas)
    spans: dict[str, list[str]] = {}
    for version, each in schemas.items():
        for name in _names(each):
            spans.setdefault(name, []).append(version)
    found: dict[str, list[str | None]] = {
        name: [None if had[0] == versions[0] else had[0], None if had[-1] == versions[-1] else had[-1]]
        for name, had in spans.items()
        if len(had) < len(versions)
    }
    for name, had in spans.items():
        assert versions.index(had[-1]) - versions.index(had[0]) + 1 == len(had), f"{name} came back"
    return _sorted({**found, **META})


def extended(spans: dict[str, list[str | None]], schemas: dict[str, Schema]) -> dict[str, dict[str, list[str | None]]]:
    """Add the last of two versions to what is known of those before it."""
    (before, earlier), (version, later) = schemas.items()
    old = _names(earlier)
    new = _names(later)
    came_back = sorted((new - old) & spans.keys())
    assert not came_back, f"{came_back} came back"
    ended = {name: [_span(spans, name)[0], before] for name in old - new}
    return _sorted({**spans, **ended, **{name: [version, None] for name in new - old}})


def _names(schema: Schema) -> set[str]:
    return {*schema, *(f"{path}@{attribute}" for path, attributes in schema.items() for attribute in attributes)}


def _span(spans: dict[str, list[str | None]], name: str) -> list[str | None]:
    """An attribute without a span of its own has that of its element."""
    return spans.get(name) or spans.get(name.partition("@")[0]) or [None, None]


def _sorted(spans: dict[str, list[str | None]]) -> dict[str, dict[str, list[str | None]]]:
    """An attribute with the span of its element needs no row."""
    own = {name: span for name, span in spans.items() if "@" not in name or spans.get(name.partition("@")[0]) != span}
    return {"spans": dict(sorted(own.items()))}


def ask(folder: Path, version: str) -> str:
    python = folder / version / "bin" / "python"
    environment = dict(os.environ)
    if not python.exists():
        python = Path(sys.executable)
        environment["PYTHONPATH"] = os.pathsep.join(map(str, (folder / version, folder / "np1")))
    asked = subprocess.run([python, "-c", ASK], env=environment, capture_output=True, text=True, check=True)
    return asked.stdout


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    schemas = {version: schema(ask(folder, version)) for version in RELEASED if (folder / version).exists()}
    if len(schemas) == len(RELEASED):
        found = history(schemas)
    elif tuple(schemas) == RELEASED[-2:]:
        found = extended(json.loads(OUT.read_text(encoding="utf-8"))["spans"], schemas)
    else:
        sys.exit(f"{folder} lacks {', '.join(version for version in RELEASED if version not in schemas)}")
    text = json.dumps(found, indent=1)
    OUT.write_text(re.sub(r"\[\s*(\S+)\s+(\S+)\s*\]", r"[\1 \2]", text) + "\n", encoding="utf-8")
