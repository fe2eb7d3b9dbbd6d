"""The source kind of docs/contributing/extending.md, added to a copy of the package as the page says, works in every command."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from mjcompose.sources.reference import SourceKind

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
SECTION = (
    (ROOT / "docs" / "contributing" / "extending.md").read_text(encoding="utf-8").partition("## Add a source kind")[2]
)
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```", SECTION.partition("\n## ")[0], re.MULTILINE | re.DOTALL)
(FILE,) = (text for language, text in BLOCKS if language == "python")
CHANGES = [text.splitlines(keepends=True) for language, text in BLOCKS if language == "diff"]
ARM = '<mujoco model="{0}"><worldbody><body name="{0}"><geom size="0.1"/></body></worldbody></mujoco>\n'
RECIPE = 'recipe: 1\nbase: "shared:arm/arm.xml"\n'

Command = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def package(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the extended package, and what it takes from the checkout."""
    folder = tmp_path_factory.mktemp("extended")
    shutil.copytree(ROOT / "composer", folder / "composer", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copytree(ROOT / "schemas", folder / "schemas")
    shutil.copy(ROOT / "action.yml", folder)
    sources = folder / "composer" / "mjcompose" / "sources"
    (sources / "shared.py").write_text(FILE, encoding="utf-8")
    kinds = (sources / "kinds.py").read_text(encoding="utf-8")
    for change in CHANGES:
        before, after = ("".join(line[1:] for line in change if line[0] != sign) for sign in "+-")
        assert kinds.count(before) == 1
        kinds = kinds.replace(before, after)
    (sources / "kinds.py").write_text(kinds, encoding="utf-8")
    return folder


@pytest.fixture
def command(package: Path, tmp_path: Path) -> Command:
    """Runs a command of the extended package in a folder with a recipe, and models of two drives beside it."""
    (tmp_path / "cell.yaml").write_text(RECIPE, encoding="utf-8")
    for drive in ("one", "two"):
        (tmp_path / drive / "arm").mkdir(parents=True)
        (tmp_path / drive / "arm" / "arm.xml").write_text(ARM.format(drive), encoding="utf-8")
    own = {"PYTHONPATH": str(package / "composer"), "MJCOMPOSE_CACHE": str(tmp_path / "store")}

    def command(*words: str, drive: str | None = "one") -> subprocess.CompletedProcess[str]:
        named = {} if drive is None else {"SHARED_MODELS": str(tmp_path / drive)}
        return subprocess.run(
            [sys.executable, "-m", "mjcompose", *words],
            cwd=tmp_path,
            env={**os.environ, **own, **named},
            capture_output=True,
            text=True,
            check=False,
        )

    return command


def test_every_command_knows_the_kind(command: Command) -> None:
    planned = command("plan", "cell.yaml", "--output-format", "json")
    assert planned.returncode == 0, planned.stderr
    assert json.loads(planned.stdout)["base"]["kind"] == "shared"
    for words in (("check", "cell.yaml"), ("fmt", "cell.yaml")):
        done = command(*words)
        assert done.returncode == 0, done.stderr
    assert "read from one/arm/arm.xml:1" in command("explain", "cell.yaml", "one").stdout
    unknown = command("plan", "cell.yaml", drive=None)
    assert unknown.returncode == 1 and "cell.yaml:2:7: error[source-not-found]" in unknown.stderr
    assert "`shared:ROBOT/path/model.xml`" in command("schema", "reference").stdout


def test_a_lock_pins_it(command: Command, tmp_path: Path) -> None:
    locked = command("lock", "cell.yaml")
    assert locked.returncode == 0, locked.stderr
    source = json.loads((tmp_path / "cell.lock").read_text(encoding="utf-8"))["sources"]["shared:arm"]
    assert source["kind"] == "shared" and [*source["files"]] == ["arm.xml"]
    build = ("build", "cell.yaml", "--locked", "--no-compile", "-o", "cell/")
    assert command(*build).returncode == 0
    manifest = json.loads((tmp_path / "cell" / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["inputs"][0]["kind"] == "shared"
    assert {"path": "shared:arm/arm.xml", "sha256": source["files"]["arm.xml"]} in manifest["read"]
    changed = command(*build, drive="two")
    assert changed.returncode == 1 and "error[source-changed]: `shared:arm` differs from the lock" in changed.stderr


def test_another_value_of_its_variable_is_not_up_to_date(command: Command, tmp_path: Path) -> None:
    build = ("build", "cell.yaml", "-o", "cell.xml")
    assert command(*build).returncode == 0
    again = command(*build)
    assert "up to date" in again.stderr + again.stdout
    other = command(*build, drive="two")
    assert other.returncode == 0 and "up to date" not in other.stderr + other.stdout
    assert 'name="two"' in (tmp_path / "cell.xml").read_text(encoding="utf-8")


@pytest.mark.parametrize("field", SourceKind.__dataclass_fields__)
def test_half_of_a_row_fails_at_import(field: str) -> None:
    half, count = re.subn(rf"^    {field}=.*\n", "", FILE, flags=re.MULTILINE)
    assert count == 1
    with pytest.raises(TypeError, match=f"missing 1 required keyword-only argument: '{field}'"):
        exec(compile(half, "shared.py", "exec"), {"__name__": "shared"})
