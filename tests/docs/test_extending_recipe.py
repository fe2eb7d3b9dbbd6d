"""The sections, verbs and checks of `docs/contributing/extending.md`, each added to a copy of the package and used."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "contributing" / "extending.md").read_text(encoding="utf-8")
RECIPE = """recipe: 1
note: made for the second bench
edit:
  - {select: {geom: pad}, hide: true}
add:
  - {to: world, body: {name: table, geom: {name: pad, size: [0.1]}}}
check: {all: {named: {}}}
"""


def chapter(title: str) -> str:
    found = re.search(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", PAGE, re.DOTALL | re.MULTILINE)
    assert found is not None, title
    return found[1]


def files(title: str) -> dict[str, str]:
    """The files of a chapter by path: each block of Python, Markdown or YAML, under the last path in backticks above it."""
    pieces = re.split(
        r"^```+(?:python|markdown|yaml)\n(.*?)^```+\n(?=\n)", chapter(title), flags=re.DOTALL | re.MULTILINE
    )
    above = pieces[::2]
    blocks = pieces[1::2]
    found = {}
    for text, block in zip(above, blocks, strict=False):
        found[re.findall(r"`((?:composer|docs)/[\w/-]+\.(?:py|md|yaml))`", text)[-1]] = block
    return found


def rows(title: str) -> list[tuple[str, str, str]]:
    """The rows of a chapter: the file, the lines to look for, and what takes their place."""
    block = re.search(r"^```diff\n(.*?)^```\n", chapter(title), re.DOTALL | re.MULTILINE)
    assert block is not None, title
    found = []
    for hunk in block[1].split("--- ")[1:]:
        path, *lines = hunk.splitlines()
        before = [line[1:] for line in lines if line[:1] in " -"]
        after = [line[1:] for line in lines if line[:1] in " +"]
        found.append((path, "\n".join(before) + "\n", "\n".join(after) + "\n"))
    return found


def extend(package: Path, title: str, but: str | None = None) -> None:
    """Carry a chapter out, except for the rows in one file."""
    for path, text in files(title).items():
        assert not (package / path).exists()
        (package / path).write_text(text, encoding="utf-8")
    for path, before, after in rows(title):
        if path != but:
            text = (package / path).read_text(encoding="utf-8")
            assert text.count(before) == 1, (path, before)
            (package / path).write_text(text.replace(before, after), encoding="utf-8")


def run(package: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {
        **os.environ,
        "PYTHONPATH": str(package / "composer"),
        "PYTHONSAFEPATH": "1",
        "MJCOMPOSE_STORE": str(package / "store"),
    }
    command = [sys.executable, "-m", "mjcompose", *arguments]
    done = subprocess.run(command, cwd=package, env=environment, capture_output=True, text=True, encoding="utf-8")
    assert str(ROOT / "composer") not in done.stderr  # it is the copy that runs
    return done


def make_schemas(package: Path) -> None:
    """What `make schemas` does for `fmt`."""
    code = "from mjcompose.language.reference_page import text; print(text())"
    environment = {**os.environ, "PYTHONPATH": str(package / "composer"), "PYTHONSAFEPATH": "1"}
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, cwd=package, env=environment, capture_output=True, text=True, check=True)
    (package / "composer" / "mjcompose" / "text" / "key_order.json").write_text(done.stdout, encoding="utf-8")


def imported(package: Path) -> subprocess.CompletedProcess[str]:
    code = "import mjcompose.pipeline.stages, mjcompose.compose.edits, mjcompose.verify.run_checks"
    environment = {**os.environ, "PYTHONPATH": str(package / "composer"), "PYTHONSAFEPATH": "1"}
    command = [sys.executable, "-c", code]
    return subprocess.run(command, cwd=package, env=environment, capture_output=True, text=True)


TITLES = ("Add a recipe section", "Add a verb of `edit`", "Add a check")


@pytest.fixture
def package(tmp_path: Path) -> Path:
    for name in ("composer", "schemas", "docs/examples"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__", "node_modules"))
    shutil.copy(ROOT / "mkdocs.yml", tmp_path)
    (tmp_path / "recipe.yaml").write_text(RECIPE, encoding="utf-8")
    return tmp_path


def test_all_of_it_works(package: Path) -> None:
    for title in TITLES:
        extend(package, title)
    make_schemas(package)
    built = run(package, "build", "recipe.yaml", "-o", "out")
    assert built.returncode == 0, built.stderr
    model = (package / "out" / "model.xml").read_text(encoding="utf-8")
    assert '<text name="note" data="made for the second bench"/>' in model
    assert re.search(r'<geom name="pad"[^>]* group="5"', model)

    planned = run(package, "plan", "recipe.yaml").stdout
    assert "note: made for the second bench" in planned
    assert "edit {geom: pad}: hide" in planned
    assert "check all: named {}" in planned

    explained = run(package, "explain", "recipe.yaml", "text note").stdout
    assert "the note of the recipe" in explained
    run(package, "fmt", "recipe.yaml")
    formatted = (package / "recipe.yaml").read_text(encoding="utf-8")
    assert formatted.index("add:") < formatted.index("note:") < formatted.index("edit:")

    text = (package / "recipe.yaml").read_text(encoding="utf-8")
    (package / "recipe.yaml").write_text(text.replace("name: table, ", ""), encoding="utf-8")
    checked = run(package, "check", "recipe.yaml")
    assert checked.returncode == 1
    assert "check `all`: 1 bodies have no name" in checked.stderr
    (package / "recipe.yaml").write_text(text.replace("hide: true", "hide: 3"), encoding="utf-8")
    refused = run(package, "check", "recipe.yaml")
    assert "error[wrong-type]: `hide` expects `true`, got a number `3`" in refused.stderr

    schema = json.loads(run(package, "schema", "recipe").stdout)
    assert schema["$defs"]["shared.note"]["description"] == "A text for programs that load the model."
    hide = schema["$defs"]["Edit"]["properties"]["hide"]
    assert hide["description"] == "viewers do not show it"
    assert schema["$defs"][hide["$ref"].rpartition("/")[2]]["anyOf"][0] == {"enum": [True]}
    assert "named" in schema["$defs"]["CheckEntry"]["properties"]


def test_a_command_counts_and_reports(package: Path) -> None:
    extend(package, "Add a command")
    (package / "recipe.yaml").write_text("recipe: 1\nadd:\n  - {to: world, geom: {size: [0.1]}}\n", encoding="utf-8")
    assert "Count the elements of a model." in run(package, "--help").stdout
    assert "--only KIND" in run(package, "count", "--help").stdout
    assert "\ngeom 1\n" in run(package, "count", "recipe.yaml").stdout
    assert json.loads(run(package, "count", "recipe.yaml", "--only", "geom", "--output-format", "json").stdout) == {
        "geom": 1
    }
    failed = run(package, "count", "none.yaml")
    assert failed.returncode == 2 and "error[file-not-found]" in failed.stderr and not failed.stdout


HALF_DONE = [
    (title, path)
    for title in TITLES
    for path in dict.fromkeys(path for path, *_ in rows(title))
    if path.startswith("composer/")
]


@pytest.mark.parametrize(("title", "path"), HALF_DONE, ids=[path for _, path in HALF_DONE])
def test_half_of_it_fails_at_import(package: Path, title: str, path: str) -> None:
    """Any file whose rows are left out."""
    extend(package, title, but=path)
    done = imported(package)
    assert done.returncode == 1
    assert re.search(r"^(TypeError|NameError|ImportError): ", done.stderr, re.MULTILINE), done.stderr


def test_a_step_without_words_fails_at_import(package: Path) -> None:
    extend(package, "Add a recipe section")
    path = package / "composer" / "mjcompose" / "plan" / "write_note.py"
    path.write_text(path.read_text(encoding="utf-8").replace("def words", "def phrase"), encoding="utf-8")
    done = imported(package)
    assert "TypeError: the step WriteNote lacks words" in done.stderr
