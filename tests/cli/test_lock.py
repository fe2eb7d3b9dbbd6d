"""`lock`, `update`, and builds that hold to a lock, with a repository and files beside the recipe."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

import pytest
from cli.shell import ARM, COVER, TOOL, run, snapshot


def git(folder: Path, *arguments: str) -> str:
    own = ["-c", "user.name=Somebody", "-c", "user.email=somebody@example.org", "-c", "commit.gpgsign=false"]
    done = subprocess.run(["git", *own, *arguments], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout.strip()


def commit(repository: Path, **files: str) -> str:
    for name, text in files.items():
        path = repository / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    git(repository, "add", "--all")
    git(repository, "commit", "-q", "-m", "a change")
    return git(repository, "rev-parse", "HEAD")


@pytest.fixture
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The current folder, with `cell.yaml`: an arm from a repository, a nested recipe from there, and a tool."""
    robots = tmp_path / "robots"
    robots.mkdir()
    git(robots, "init", "-q", "-b", "main")
    nested = "recipe: 1\nbase: ./arm.xml\nattach:\n  tool: {model: ../tool.xml, site: flange}\n"
    files = {
        "arm/arm.xml": ARM,
        "arm/meshes/cover.obj": COVER,
        "arm/LICENSE": "As you like.\n",
        "tool.xml": TOOL,
    }
    commit(robots, **files, **{"arm/cell.yaml": nested})
    work = tmp_path / "cell"
    work.mkdir()
    (work / "tool.xml").write_text(TOOL)
    (work / "cell.yaml").write_text(
        f"recipe: 1\nbase: git+file://{robots}@main#arm/arm.xml\nattach:\n"
        f"  tool: {{model: ./tool.xml, site: flange}}\n"
        f"  cell: {{model: git+file://{robots}@main#arm/cell.yaml}}\n"
    )
    monkeypatch.chdir(work)
    monkeypatch.setenv("MJCOMPOSE_CACHE", str(tmp_path / "store"))
    return work


def told(work: Path) -> dict[str, dict[str, object]]:
    sources = json.loads((work / "cell.lock").read_text())["sources"]
    assert isinstance(sources, dict)
    return sources


def test_a_lock_has_every_source_once(work: Path) -> None:
    result = run("lock", "cell.yaml")
    assert result.exit_code == 0, result.stderr
    sources = told(work)
    robots = f"git+file://{work.parent}/robots@main"
    assert set(sources) == {robots, "./tool.xml"}
    locked = sources[robots]
    assert locked["commit"] == git(work.parent / "robots", "rev-parse", "HEAD")
    assert locked["tree"] == git(work.parent / "robots", "rev-parse", "HEAD^{tree}")
    expected = {"arm/arm.xml", "arm/meshes/cover.obj", "arm/LICENSE", "arm/cell.yaml", "tool.xml"}
    assert set(locked["files"]) == expected  # type: ignore[call-overload]
    assert locked["licences"] == ["arm/LICENSE"]
    assert locked["used_by"] == ["base", "cell", "cell/base", "cell/tool"]
    assert "up to date" in run("lock", "cell.yaml").stdout


def test_a_locked_build_ignores_what_moved_and_needs_no_network(work: Path) -> None:
    assert run("lock", "cell.yaml").exit_code == 0
    assert run("build", "cell.yaml", "-o", "one/", "--locked").exit_code == 0
    robots = work.parent / "robots"
    commit(robots, **{"arm/arm.xml": ARM.replace("0.02", "0.03")})
    assert run("build", "cell.yaml", "-o", "two/").exit_code == 0
    robots.rename(work.parent / "gone")
    result = run("build", "cell.yaml", "-o", "three/", "--frozen")
    assert result.exit_code == 0, result.stderr
    assert snapshot(work / "one") == snapshot(work / "two") == snapshot(work / "three")


def test_update_follows_a_branch_and_says_what_changed(work: Path) -> None:
    run("lock", "cell.yaml")
    new = commit(work.parent / "robots", **{"arm/arm.xml": ARM.replace("0.02", "0.03")})
    assert "up to date" in run("lock", "cell.yaml").stdout
    assert "up to date" in run("update", "cell.yaml", "tool").stdout
    result = run("update", "cell.yaml", "base")
    assert f"is now {new[:12]}" in result.stdout
    assert "`arm/arm.xml` changed" in result.stdout
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0


def test_update_of_a_name_that_is_none(work: Path) -> None:
    run("lock", "cell.yaml")
    before = (work / "cell.lock").read_bytes()
    result = run("update", "cell.yaml", "tol")
    assert result.exit_code == 2
    assert "did you mean `tool`?" in result.stderr
    assert (work / "cell.lock").read_bytes() == before


def test_without_a_lock_a_locked_build_is_one_error(work: Path) -> None:
    result = run("build", "cell.yaml", "-o", "out/", "--locked")
    assert result.exit_code == 1
    assert "there is no lock `cell.lock`" in result.stderr
    assert "1 error" in result.stderr
    assert not (work / "out").exists()


def test_a_stale_lock_is_a_warning_and_locked_an_error(work: Path) -> None:
    run("lock", "cell.yaml")
    (work / "more.xml").write_text(TOOL)
    with (work / "cell.yaml").open("a") as recipe:
        recipe.write("  more: {model: ./more.xml}\n")
    assert "warning[lock-stale]" in run("build", "cell.yaml", "-o", "out/").stderr
    before = snapshot(work / "out")
    result = run("build", "cell.yaml", "-o", "out/", "--locked")
    assert result.exit_code == 1
    assert "cell.yaml:6:3: error[lock-stale]: `./more.xml` is not in the lock `cell.lock`" in result.stderr
    assert snapshot(work / "out") == before
    assert "./more.xml: locked" in run("lock", "cell.yaml").stdout


def test_own_files_that_changed_are_a_warning_and_locked_an_error(work: Path) -> None:
    run("lock", "cell.yaml")
    (work / "tool.xml").write_text(TOOL.replace("0.01", "0.02"))
    loose = run("build", "cell.yaml", "-o", "out/")
    assert loose.exit_code == 0
    assert "warning[source-changed]" in loose.stderr
    locked = run("build", "cell.yaml", "-o", "out/", "--locked")
    assert locked.exit_code == 1
    assert "`tool.xml` changed" in locked.stderr
    assert run("lock", "cell.yaml").exit_code == 0
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0


def test_a_store_that_was_tampered_with_is_an_error_that_says_what_changed(work: Path) -> None:
    run("lock", "cell.yaml")
    (file,) = (work.parent / "store" / "git").rglob("arm.xml")
    file.chmod(0o644)
    file.write_text(ARM.replace("0.02", "0.03"))
    result = run("build", "cell.yaml", "-o", "out/")
    assert result.exit_code == 1
    assert "error[source-changed]" in result.stderr
    assert "`arm/arm.xml` changed" in result.stderr
    assert run("lock", "cell.yaml").exit_code == 1
    assert run("cache", "verify").exit_code == 1
    assert run("cache", "verify", "--fix").exit_code == 0
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0


def test_a_broken_lock_is_one_error_and_stays(work: Path) -> None:
    run("lock", "cell.yaml")
    text = (work / "cell.lock").read_text().replace('"lock": 1', '"lock": 7')
    (work / "cell.lock").write_text(text)
    for command in ("build", "check", "plan", "lock", "update"):
        result = run(command, "cell.yaml")
        assert result.exit_code == 1
        assert "cell.lock:2:11: error[lock-invalid]" in result.stderr
        assert "1 error" in result.stderr
    assert (work / "cell.lock").read_text() == text


def test_lock_of_no_recipe(work: Path) -> None:
    result = run("lock", "cel.yaml")
    assert result.exit_code == 1
    assert "did you mean `cell.yaml`?" in result.stderr
    assert not (work / "cel.lock").exists()


def test_a_recipe_without_sources(work: Path) -> None:
    (work / "cell.yaml").write_text("recipe: 1\nname: empty\n")
    assert run("lock", "cell.yaml").stdout == "  no sources to pin\nwrote cell.lock\n"
