from __future__ import annotations

import os
import shutil
import subprocess
from contextlib import ExitStack
from pathlib import Path

import pytest
from mjcompose.contrast.text import as_data, render, render_markdown as markdown
from mjcompose.mujoco.engine import Session
from mjcompose.sides.operand import read_operand
from mjcompose.sides.revision import RevisionError, check_out, split
from mjcompose.sides.side import load
from mjcompose.sources.context import Context
from mjcompose.tools.diff.diff import diff
from mjcompose.tools.lock import write_lock
from mjcompose.trace.traced import trace

CASE = Path(__file__).parents[1] / "tools" / "diff" / "cases" / "sources" / "a"
pytestmark = pytest.mark.skipif(shutil.which("git") is None, reason="there is no git command")


def _git(folder: Path, *arguments: str) -> str:
    identity = {f"GIT_{who}_{what}": "x@example.org" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    done = subprocess.run(
        ["git", "-C", str(folder), *arguments],
        check=True,
        capture_output=True,
        text=True,
        env={**os.environ, **identity, "GIT_CONFIG_GLOBAL": os.devnull},
    )
    return done.stdout


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A commit with `cells/recipe.yaml` and its parts; in the folder the arm has been changed since."""
    folder = tmp_path / "repository"
    shutil.copytree(CASE, folder / "cells")
    _git(folder, "init", "-q")
    _git(folder, "add", ".")
    _git(folder, "commit", "-q", "-m", "one")
    arm = folder / "cells" / "arm.xml"
    arm.write_text(arm.read_text().replace('mass="2"', 'mass="3"'))
    return folder


def test_revision_and_path() -> None:
    assert split("HEAD^:a.yaml") == ("HEAD^", "a.yaml")
    assert split("a.yaml") is None and split(":a.yaml") is None and split("main:") is None
    assert split("C:\\a.yaml") is None


def test_a_revision_against_the_folder(repository: Path) -> None:
    before = _git(repository, "status", "--porcelain")
    context = Context(folder=repository)
    with Session() as session:
        found = diff("HEAD:cells/recipe.yaml", "cells/recipe.yaml", context, session)
        same = diff("HEAD:cells/recipe.yaml", "HEAD:cells/recipe.yaml", context, session)
    assert found is not None and same is not None, context.sink.diagnostics
    assert same.same and same.same_bytes
    assert "cells/arm.xml:13\n" in render(found)
    assert "mass of body `upper`: 2 kg → 3 kg (+50 %)" in render(found)
    span = found.groups[0].cause
    assert span is not None and span.before is not None and span.before.file == "HEAD:cells/arm.xml"
    assert _git(repository, "status", "--porcelain") == before


def test_the_path_is_that_of_the_folder_one_is_in(repository: Path) -> None:
    context = Context(folder=repository / "cells")
    with Session() as session:
        found = diff("HEAD:recipe.yaml", "recipe.yaml", context, session)
    assert found is not None and "\narm.xml:13\n" in render(found)


def test_a_part_beside_the_folder_one_is_in(repository: Path) -> None:
    (repository / "recipes").mkdir()
    (repository / "recipes" / "one.yaml").write_text("recipe: 1\nbase: ../cells/arm.xml\n")
    _git(repository, "add", "recipes")
    _git(repository, "commit", "-q", "-m", "two")
    context = Context(folder=repository / "recipes")
    with Session() as session:
        found = diff("HEAD:one.yaml", "one.yaml", context, session)
    assert found is not None
    cause = found.groups[0].cause
    assert cause is not None and cause.before is not None
    assert cause.before.file == "HEAD:../cells/arm.xml"


def test_a_source_that_is_locked_at_another_commit(repository: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lines of the source that differ, and not only the part whose commit is another."""
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(repository.parent / "store"))
    source = f"git+file://{repository}@HEAD"
    project = repository.parent / "project"
    project.mkdir()
    (project / "one.yaml").write_text(f"recipe: 1\nattach: {{arm: {{model: '{source}#cells/arm.xml'}}}}\n")
    assert write_lock(Path("one.yaml"), None, Context(folder=project)) is not None
    _git(project, "init", "-q")
    _git(project, "add", ".")
    _git(project, "commit", "-q", "-m", "one")
    _git(repository, "commit", "-q", "-a", "-m", "two")
    assert write_lock(Path("one.yaml"), (), Context(folder=project)) is not None
    context = Context(folder=project)
    with Session() as session:
        found = diff("HEAD:one.yaml", "one.yaml", context, session)
    assert found is not None, context.sink.diagnostics
    assert f"\n{source}#cells/arm.xml:13\n" in render(found)
    assert "mass of body `arm/upper`: 2 kg → 3 kg (+50 %)" in render(found)
    cause = found.groups[0].cause
    assert cause is not None and cause.before is not None and cause.after is not None
    assert cause.before.file == cause.after.file == f"{source}#cells/arm.xml"


def test_a_file_that_is_gone_from_the_folder(repository: Path, tmp_path: Path) -> None:
    shutil.rmtree(repository / "cells")
    into = tmp_path / "out"
    into.mkdir()
    _, path = check_out("HEAD", repository / "cells" / "recipe.yaml", into, os.environ)
    assert path.read_bytes() == (CASE / "recipe.yaml").read_bytes()
    assert (path.parent / "arm.xml").is_file()


def test_faults(repository: Path, tmp_path: Path) -> None:
    path = repository / "cells" / "recipe.yaml"
    with pytest.raises(RevisionError, match="the revision `nowhere` does not exist"):
        check_out("nowhere", path, tmp_path, os.environ)
    with pytest.raises(RevisionError, match="the revision `--help` does not exist"):
        check_out("--help", path, tmp_path, os.environ)
    with pytest.raises(RevisionError, match="is not in a git repository"):
        check_out("HEAD", tmp_path / "a.yaml", tmp_path, {**os.environ, "GIT_CEILING_DIRECTORIES": str(tmp_path)})
    with pytest.raises(RevisionError, match="the git command is not installed"):
        check_out("HEAD", path, tmp_path, {"PATH": str(tmp_path)})


def test_faults_are_told_where_they_are(repository: Path) -> None:
    recipe = repository / "cells" / "recipe.yaml"
    recipe.write_text(recipe.read_text().replace("flange", "flang"))
    _git(repository, "commit", "-q", "-a", "-m", "two")
    context = Context(folder=repository)
    with Session() as session:
        assert diff("HEAD:cells/recipe.yaml", "HEAD:cells/gone.yaml", context, session) is None
    told = {each.code: each for each in context.sink.diagnostics}
    assert told.keys() == {"attach-place", "file-not-found"}
    span = told["attach-place"].span
    assert span is not None and (span.file, span.line) == ("HEAD:cells/recipe.yaml", 7)
    assert "`cells/gone.yaml` does not exist in revision `HEAD`" in told["file-not-found"].message


def test_parts_beside_the_repository_are_those_of_the_work_tree(repository: Path, tmp_path: Path) -> None:
    models = tmp_path / "models" / "arm"
    (models / "meshes").mkdir(parents=True)
    shape = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (models / "meshes" / "m.obj").write_text(shape)
    (models / "arm.xml").write_text(
        '<mujoco><compiler meshdir="meshes"/><asset><mesh name="m" file="m.obj"/></asset>'
        '<worldbody><body name="a"><geom type="mesh" mesh="m"/></body></worldbody></mujoco>'
    )
    recipe = repository / "cells" / "outside.yaml"
    recipe.write_text("recipe: 1\nbase: ../../models/arm/arm.xml\n")
    _git(repository, "add", ".")
    _git(repository, "commit", "-q", "-m", "two")
    recipe.write_text(recipe.read_text() + "add: [{to: a, site: {name: new}}]\n")
    context = Context(folder=repository / "cells")
    with Session() as session:
        found = diff("HEAD:outside.yaml", "outside.yaml", context, session)
    assert found is not None, context.sink.errors
    assert [str(each.kind) for each in found.contrast.changes] == ["site"]
    assert found.a.outside == ("../models/arm/arm.xml", "../models/arm/meshes/m.obj") and found.b.outside == ()
    assert "`../models/arm/arm.xml`, `../models/arm/meshes/m.obj`: outside the repository" in render(found)
    assert as_data(found)["a"]["outside"] == [*found.a.outside]
    assert "as now in the work tree" in markdown(found)
    assert (models / "meshes" / "m.obj").read_text() == shape


@pytest.mark.parametrize("allow", ["", "allow: [convert-loss]"])
def test_what_an_edit_allows_is_allowed_whoever_composes(tmp_path: Path, allow: str) -> None:
    (tmp_path / "m.xml").write_text(
        '<mujoco><worldbody><body><joint name="j"/><geom size=".1"/></body></worldbody>'
        '<actuator><position name="p" joint="j" kp="3" timeconst=".1"/></actuator></mujoco>'
    )
    edit = f"{{select: {{actuator: p}}, convert: {{to: velocity, kv: 1}}{', ' + allow if allow else ''}}}"
    (tmp_path / "r.yaml").write_text(f"recipe: 1\nbase: ./m.xml\nedit:\n  - {edit}\n")
    context = Context(folder=tmp_path)
    found = []
    with ExitStack() as opened, Session() as session:
        operand = read_operand("r.yaml", context, opened)
        assert operand is not None and load(operand, "it", session) is not None
        found.append(operand.context)
    assert trace(Path("r.yaml"), context) is not None
    for each in (*found, context):
        assert ("convert-loss" in {one.code for one in each.sink.diagnostics}) == (not allow)
