"""The package of docs/contributing/extending.md, built and installed, brings one of each; a fetched recipe loads none of it."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "contributing" / "extending.md").read_text(encoding="utf-8")
MODEL = """<mujoco model="bot"><worldbody><body name="a"><joint name="j"/><geom name="g" size="1"/></body></worldbody>
<actuator><position name="p" joint="j" kp="1"/></actuator></mujoco>
"""
RECIPE = """recipe: 1
base:
  model: shared:bot/m.xml
  edit:
  - {select: {geom: g}, hide: true}
  - {select: {actuator: p}, datasheet: {model: x200, bandwidth: 5}}
check:
  all: {named: {}}
"""
PLAN = """import sys
from mjcompose.cli.main import main
try:
    main()
finally:
    print([name for name in sys.modules if name.startswith("mjcompose_lab")], file=sys.stderr)
"""

Run = Callable[..., subprocess.CompletedProcess[str]]


def _python(heading: str) -> str:
    """Return the Python blocks of a section as one module.

    `from __future__` stands once, at its top, and nothing imports the form of a check or verb, which is in the module.
    """
    section = PAGE.partition(f"## {heading}\n")[2].partition("\n## ")[0]
    future = "from __future__ import annotations\n"
    blocks = re.findall(r"^```python\n(.*?)^```", section, re.MULTILINE | re.DOTALL)
    assert blocks
    module = "\n".join(blocks).replace(future, "")
    return future + re.sub(
        r"^from mjcompose\.language\.(verbs|checks)\.\w+ import \w+\n", "", module, flags=re.MULTILINE
    )


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder into which pip installed the package."""
    folder = tmp_path_factory.mktemp("lab")
    inside = folder / "mjcompose_lab"
    inside.mkdir()
    (inside / "__init__.py").write_text("")
    sections = {"shared": "Add a source kind", "named": "Add a check", "hide": "Add a verb of `edit`"}
    sections["count"] = "Add a command"
    for name, heading in {**sections, "sapien": "Add a target"}.items():
        (inside / f"{name}.py").write_text(_python(heading), encoding="utf-8")
    section = PAGE.partition("## From a package of your own\n")[2].partition("\n## ")[0]
    for name, text in re.findall(r'^```\w+ title="([^"]+)"\n(.*?)^```', section, re.MULTILINE | re.DOTALL):
        (folder / name).write_text(text, encoding="utf-8")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(folder / "site")]
    done = subprocess.run([*pip, str(folder)], capture_output=True, text=True, check=False)
    if done.returncode:
        pytest.skip(f"pip cannot build a package here: {done.stderr[-200:]}")
    return folder / "site"


def _run_in(folder: Path, *sites: Path) -> Run:
    path = os.pathsep.join([str(ROOT / "composer"), *map(str, sites)])
    named = {"PYTHONPATH": path, "MJCOMPOSE_CACHE": str(folder / "store"), "SHARED_MODELS": str(folder / "models")}

    def run(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *words],
            cwd=folder,
            env={**os.environ, **named},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


@pytest.fixture
def run(installed: Path, tmp_path: Path) -> Run:
    """Run Python in a folder with a recipe and a model, with the package on its path."""
    (tmp_path / "models" / "bot").mkdir(parents=True)
    (tmp_path / "models" / "bot" / "m.xml").write_text(MODEL)
    (tmp_path / "LICENSE").write_text("MIT License\n")
    (tmp_path / "cell.yaml").write_text(RECIPE)
    return _run_in(tmp_path, installed)


def test_one_of_each_is_used(run: Run, tmp_path: Path) -> None:
    built = run("-m", "mjcompose", "build", "cell.yaml", "--target", "sapien", "-o", "out.zip")
    assert built.returncode == 0, built.stderr
    with zipfile.ZipFile(tmp_path / "out.zip") as bundle:
        model = bundle.read("model.xml").decode()
        manifest = json.loads(bundle.read("manifest.json"))
    assert 'group="5"' in model and "armature" in model
    assert manifest["extensions"] == {"mjcompose-lab": "0.4.0"}
    counted = run("-m", "mjcompose", "count", "cell.yaml", "--only", "geom", "--output-format", "json")
    assert json.loads(counted.stdout) == {"geom": 1}, counted.stderr
    assert "count " in run("-m", "mjcompose", "--help").stdout
    locked = run("-m", "mjcompose", "lock", "cell.yaml")
    assert locked.returncode == 0, locked.stderr
    assert "mjcompose-lab" in (tmp_path / "cell.lock").read_text()
    doctor = run("-m", "mjcompose", "doctor").stdout
    assert all(word in doctor for word in ("mjcompose-lab 0.4.0", "shared", "named", "hide", "sapien", "x200"))


def test_a_check_of_a_package_finds_what_is_wrong(run: Run, tmp_path: Path) -> None:
    (tmp_path / "models" / "bot" / "m.xml").write_text(MODEL.replace('body name="a"', "body"))
    done = run("-m", "mjcompose", "check", "cell.yaml")
    assert done.returncode == 1 and "1 bodies have no name" in done.stderr, done.stderr


@pytest.mark.skipif(shutil.which("git") is None, reason="no git")
@pytest.mark.parametrize(
    "piece",
    [
        "check: {all: {named: {}}}",
        "base: {model: m.xml, edit: [{select: {geom: g}, hide: true}]}",
        "base: 'shared:bot/m.xml'",
        "attach: {a: {model: 'shared:bot/m.xml'}}",
    ],
    ids=["check", "verb", "source", "source of a part"],
)
def test_a_fetched_recipe_loads_nothing(run: Run, tmp_path: Path, piece: str) -> None:
    there = tmp_path / "there"
    there.mkdir()
    base = "" if piece.startswith("base") else "base: m.xml\n"
    (there / "c.yaml").write_text(f"recipe: 1\n{base}{piece}\n")
    (there / "m.xml").write_text(MODEL)
    git = ["git", "-C", str(there), "-c", "user.name=a", "-c", "user.email=a@b"]
    for words in (["init", "-q"], ["add", "."], ["commit", "-qm", "."]):
        subprocess.run([*git, *words], check=True)
    address = there.as_uri().replace("file:", "git+file:")
    outer = f"recipe: 1\ntrust: {{references: ['{address}']}}\nbase: {address}@HEAD#c.yaml\n"
    (tmp_path / "outer.yaml").write_text(outer)
    done = run("-c", PLAN, "plan", "outer.yaml")
    assert "error[extension-refused]" in done.stderr, done.stderr
    assert done.stderr.rstrip().endswith("[]")


def test_a_row_that_is_none_and_a_word_of_two_packages_are_told(installed: Path, run: Run, tmp_path: Path) -> None:
    broken = tmp_path / "site"
    shutil.copytree(installed, broken)
    (broken / "mjcompose_lab" / "named.py").write_text("KIND = None.word\n")
    done = _run_in(tmp_path, broken)("-m", "mjcompose", "plan", "cell.yaml")
    assert "cell.yaml:8:9: error[extension-broken]" in done.stderr and "mjcompose-lab 0.4.0" in done.stderr
    assert "Traceback" not in done.stderr
    half = (
        (broken / "mjcompose_lab" / "hide.py").read_text(encoding="utf-8").replace("def carry_out", "def carried_out")
    )
    (broken / "mjcompose_lab" / "hide.py").write_text(half, encoding="utf-8")
    done = _run_in(tmp_path, broken)("-m", "mjcompose", "plan", "cell.yaml")
    assert "its module has no function `carry_out`" in done.stderr and "Traceback" not in done.stderr
    other = tmp_path / "other"
    (other / "tall-1.0.dist-info").mkdir(parents=True)
    (other / "tall-1.0.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: tall\nVersion: 1.0\n")
    (other / "tall-1.0.dist-info" / "entry_points.txt").write_text("[mjcompose.checks]\nnamed = tall\n")
    done = _run_in(tmp_path, installed, other)("-m", "mjcompose", "plan", "cell.yaml")
    assert "error[extension-clash]" in done.stderr and "tall 1.0" in done.stderr
