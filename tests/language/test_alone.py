"""The language in a wheel of its own, in an environment that has only pydantic and PyYAML: it names nothing above."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import venv
import zipfile
from importlib.metadata import distribution
from pathlib import Path

import pytest
from packaging.requirements import Requirement

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "composer" / "mjcompose"
WHOLE = ("base", "text", "tree", "language")
ALONE = ("__init__.py", "py.typed", "mujoco/__init__.py", "mujoco/arrays.py", "mujoco/attributes.py")
"""Tables of what MuJoCo compiles: the check `expect` names attributes of a compiled model."""
WITHOUT = "language/reference_page.py"
"""A program that writes our documentation, which lists the kinds of sources, too."""
LIBRARIES = ("pydantic", "PyYAML")

PROGRAM = """
import json, sys
from pathlib import Path
from mjcompose.base.sink import Sink
from mjcompose.language.expand import expand
from mjcompose.language.schema import text
from mjcompose.language.validate import validate_what_remains
from mjcompose.text.load import load

def faults(path):
    sink = Sink()
    node = load(Path(path).read_text(encoding="utf-8"), path, sink)
    if node is not None:
        validate_what_remains(expand(node, {}, sink).document, sink)
    return [(each.code, each.message, each.span and each.span.line) for each in sink.diagnostics]

heavy = ("lxml", "numpy", "mujoco", "mjcompose.homes", "mjcompose.compose", "mjcompose.verify", "mjcompose.sources")
print(json.dumps({
    "faults": {path: faults(path) for path in sys.argv[1:]},
    "schema": text(),
    "heavy": [name for name in heavy if name in sys.modules],
}))
"""

WRONG = {
    "verb": ("edit: [{select: {geom: pad}, sett: {mass: 1}}]", "unknown-key"),
    "value of a verb": ("edit: [{select: {geom: pad}, simplify: {faces: 1}}]", "out-of-range"),
    "element of a verb": ("edit: [{select: {geom: pad}, convert: {to: motor}}]", "wrong-type"),
    "check": ("check: {a: {setles: {}}}", "unknown-key"),
    "attribute of a check": (
        "check: {a: {expect: {select: {joint: j}, attr: dampng, equals: 1}}}",
        "unknown-attribute",
    ),
    "rule": ("check: {a: {lint: {except: [unused-mush]}}}", "wrong-keyword"),
    "target": ("check: {a: {targets: [drak]}}", "wrong-keyword"),
}


def build_wheel(folder: Path) -> Path:
    """Write the wheel of the language."""
    wheel = folder / "mjcompose_language-0.1.0-py3-none-any.whl"
    files = [path for room in WHOLE for path in sorted((PACKAGE / room).rglob("*")) if path.suffix != ".pyc"]
    files += [PACKAGE / name for name in ALONE]
    about = "Metadata-Version: 2.1\nName: mjcompose-language\nVersion: 0.1.0\n"
    about += "".join(f"Requires-Dist: {name}\n" for name in LIBRARIES)
    with zipfile.ZipFile(wheel, "w") as archive:
        for path in files:
            name = path.relative_to(PACKAGE).as_posix()
            if path.is_file() and name != WITHOUT:
                archive.write(path, f"mjcompose/{name}")
        archive.write(ROOT / "schemas" / "mjcf.json", "mjcompose/tree/mjcf.json")
        archive.writestr("mjcompose_language-0.1.0.dist-info/METADATA", about)
        archive.writestr("mjcompose_language-0.1.0.dist-info/WHEEL", "Wheel-Version: 1.0\nTag: py3-none-any\n")
        archive.writestr("mjcompose_language-0.1.0.dist-info/RECORD", "")
    return wheel


def with_dependencies(*names: str) -> set[str]:
    """Return the distributions with everything that they need on this platform."""
    found: set[str] = set()
    left = list(names)
    while left:
        name = left.pop()
        if name in found:
            continue
        found.add(name)
        requirements = map(Requirement, distribution(name).requires or ())
        left += [each.name for each in requirements if each.marker is None or each.marker.evaluate({"extra": ""})]
    return found


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the Python of an environment with the wheel and the two libraries."""
    folder = tmp_path_factory.mktemp("alone")
    venv.create(folder / "env", with_pip=False)
    (site,) = (folder / "env").rglob("site-packages")
    zipfile.ZipFile(build_wheel(folder)).extractall(site)
    for name in with_dependencies(*LIBRARIES):
        installed = distribution(name)
        for file in installed.files or ():
            if ".." not in file.parts and file.suffix != ".pyc":
                target = site / file
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(str(installed.locate_file(file)), target)
    return folder / "env" / ("Scripts" if os.name == "nt" else "bin") / "python"


def answer(python: Path | str, *recipes: Path) -> dict[str, object]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    command = [str(python), "-c", PROGRAM, *map(str, recipes)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, encoding="utf-8", check=False)
    assert not done.returncode, done.stderr
    answered: dict[str, object] = json.loads(done.stdout)
    return answered


def test_it_validates_recipes_and_writes_the_schema(python: Path, tmp_path: Path) -> None:
    recipes = [
        *sorted((ROOT / "recipes").glob("*.yaml")),
        *sorted((ROOT / "docs" / "examples" / "keys").glob("*.yaml")),
    ]
    wrong: dict[str, str] = {}
    for name, (text, code) in WRONG.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"recipe: 1\nbase: ./arm.xml\n{text}\n", encoding="utf-8")
        wrong[str(path)] = code
    found = answer(python, *recipes, *map(Path, wrong))
    assert found["heavy"] == []
    assert found["schema"] == (ROOT / "schemas" / "recipe.schema.json").read_text(encoding="utf-8")
    assert len(recipes) > 20
    faults = found["faults"]
    assert isinstance(faults, dict)
    assert {path: faults[path][0][0] for path in wrong} == wrong
    assert faults == answer(sys.executable, *recipes, *map(Path, wrong))["faults"]
