"""`lock`, and builds that hold to a lock, with a repository and files beside the recipe."""

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
    files = {"arm/arm.xml": ARM, "arm/meshes/cover.obj": COVER, "arm/LICENSE": "As you like.\n", "tool.xml": TOOL}
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
    assert locked["licenses"] == ["arm/LICENSE"]
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
    assert "up to date" in run("lock", "cell.yaml", "--upgrade-source", "tool").stdout
    result = run("lock", "cell.yaml", "--upgrade-source", "base")
    assert f"is now {new[:12]}" in result.stdout
    assert "`arm/arm.xml` changed" in result.stdout
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0


def test_update_of_a_name_that_is_none(work: Path) -> None:
    run("lock", "cell.yaml")
    before = (work / "cell.lock").read_bytes()
    result = run("lock", "cell.yaml", "--upgrade-source", "tol")
    assert result.exit_code == 2
    assert "did you mean `tool`?" in result.stderr
    assert (work / "cell.lock").read_bytes() == before


def test_without_a_lock_a_locked_build_is_one_error(work: Path) -> None:
    result = run("build", "cell.yaml", "-o", "out/", "--locked")
    assert result.exit_code == 1
    assert "the lock `cell.lock` does not exist" in result.stderr
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


def test_what_nothing_uses_any_more_makes_a_lock_stale(work: Path) -> None:
    run("lock", "cell.yaml")
    whole = (work / "cell.yaml").read_text()
    lines = [line for line in whole.splitlines(keepends=True) if "./tool.xml" not in line]
    (work / "cell.yaml").write_text("".join(lines))
    assert run("build", "cell.yaml", "--no-compile").exit_code == 0
    for command in (("build", "--no-compile"), ("check",), ("build", "--frozen", "--all")):
        result = run(*command, "cell.yaml", "--locked")
        assert result.exit_code == 1
        assert "error[lock-stale]: `./tool.xml` is in the lock `cell.lock`, and nothing uses it" in result.stderr
    run("lock", "cell.yaml")
    assert run("build", "cell.yaml", "--no-compile", "--locked").exit_code == 0


@pytest.mark.parametrize(
    "choice",
    [
        "variants: {arm: {yes: {}, no: {name: other}}}\n",
        "params: {n: 1}\nadd:\n  - {to: world, site: {name: s}, when: '${n == 2}'}\n",
        "params: {n: 1}\nmatrix: {axes: {n: [1, 2]}}\n",
    ],
)
def test_what_another_choice_may_use_does_not_make_a_lock_stale(work: Path, choice: str) -> None:
    run("lock", "cell.yaml")
    lines = [line for line in (work / "cell.yaml").read_text().splitlines(keepends=True) if "tool" not in line]
    (work / "cell.yaml").write_text("".join(lines) + choice)
    assert run("build", "cell.yaml", "--no-compile", "--locked").exit_code == 0


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


def _tampered(work: Path, name: str = "arm.xml") -> Path:
    (file,) = (work.parent / "store" / "git").rglob(name)
    file.chmod(0o644)
    file.write_text(ARM.replace("0.02", "0.03"))
    return file


def test_offline_a_store_that_was_tampered_with_is_an_error_that_says_what_changed(work: Path) -> None:
    run("lock", "cell.yaml")
    assert run("build", "cell.yaml", "-o", "out/").exit_code == 0
    before = snapshot(work / "out"), (work / "cell.lock").read_text()
    _tampered(work)
    for command in (("build", "cell.yaml", "-o", "out/"), ("check", "cell.yaml")):
        result = run(*command, "--offline")
        assert result.exit_code == 1
        assert result.stderr.count("error[source-changed]: `git+file:") == 1
        assert "`arm/arm.xml` changed: " in result.stderr and "was stored" in result.stderr
        assert "run `mjcompose cache verify --fix`" in result.stderr
    assert run("lock", "cell.yaml", "--offline").exit_code == 1  # what is damaged is not locked
    assert (snapshot(work / "out"), (work / "cell.lock").read_text()) == before
    assert run("cache", "verify").exit_code == 1
    assert run("cache", "verify", "--fix").exit_code == 0
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0


@pytest.mark.parametrize("is_locked", [True, False])
@pytest.mark.parametrize("is_gone", [True, False])
def test_what_is_damaged_in_the_store_is_fetched_again(work: Path, is_locked: bool, is_gone: bool) -> None:
    if is_locked:
        run("lock", "cell.yaml")
    assert run("build", "cell.yaml", "-o", "out/").exit_code == 0
    before = snapshot(work / "out")
    for command in (("build", "cell.yaml", "-o", "out/"), ("check", "cell.yaml"), ("lock", "cell.yaml")):
        file = _tampered(work)
        if is_gone:
            file.unlink()
        result = run(*command)
        assert result.exit_code == 0, result.stderr
        assert file.read_text() == ARM and snapshot(work / "out") == before
    assert run("cache", "verify").exit_code == 0


def test_a_broken_lock_is_one_error_and_stays(work: Path) -> None:
    run("lock", "cell.yaml")
    text = (work / "cell.lock").read_text().replace('"lock": 1', '"lock": 7')
    (work / "cell.lock").write_text(text)
    for command in ("build", "check", "plan", "lock"):
        result = run(command, "cell.yaml")
        assert result.exit_code == 1
        assert "cell.lock:2:11: error[lock-invalid]" in result.stderr
        assert "1 error" in result.stderr
    assert (work / "cell.lock").read_text() == text


def test_a_merge_keeps_what_both_sides_pin(work: Path) -> None:
    robots = work.parent / "robots"
    recipe = (work / "cell.yaml").read_text()
    one = recipe.replace("@main#arm/arm.xml", "@v1#arm/arm.xml")
    git(robots, "tag", "v1")
    (work / "cell.yaml").write_text(one)
    run("lock", "cell.yaml")
    ours = (work / "cell.lock").read_text()
    pins = {id: each.get("commit") for id, each in told(work).items()}
    commit(robots, **{"tool.xml": TOOL.replace("0.01", "0.02")})
    git(robots, "tag", "v2")
    (work / "cell.yaml").write_text(recipe.replace("@main#", "@v2#"))
    (work / "cell.lock").unlink()
    run("lock", "cell.yaml")
    theirs = (work / "cell.lock").read_text()
    pins |= {id: each.get("commit") for id, each in told(work).items()}
    (work / "cell.lock").write_text(f"<<<<<<< HEAD\n{ours}=======\n{theirs}>>>>>>> theirs\n")
    (work / "cell.yaml").write_text(one + f"  more: {{model: git+file://{robots}@v2#tool.xml, pos: [1, 0, 0]}}\n")
    commit(robots, **{"tool.xml": TOOL})
    assert "run `mjcompose lock`, which keeps the pins of both sides" in run("build", "cell.yaml").stderr
    assert run("lock", "cell.yaml").exit_code == 0
    assert {id: each.get("commit") for id, each in told(work).items()} == pins
    assert run("build", "--locked", "cell.yaml").exit_code == 0


def test_what_a_merge_pins_in_two_ways_is_for_a_person_to_settle(work: Path) -> None:
    run("lock", "cell.yaml")
    ours = (work / "cell.lock").read_text()
    new = commit(work.parent / "robots", **{"tool.xml": TOOL.replace("0.01", "0.02")})
    run("lock", "cell.yaml", "--upgrade")
    theirs = (work / "cell.lock").read_text()
    text = f"<<<<<<< HEAD\n{ours}=======\n{theirs}>>>>>>> theirs\n"
    (work / "cell.lock").write_text(text)
    result = run("lock", "cell.yaml")
    assert result.exit_code == 1
    assert result.stderr.count("error[lock-invalid]: the two sides of the merge in `cell.lock` pin") == 1
    assert f"theirs: {new}" in result.stderr
    assert (work / "cell.lock").read_text() == text
    assert run("lock", "cell.yaml", "--upgrade-source", "base").exit_code == 0
    assert (work / "cell.lock").read_text() == theirs


def test_lock_of_no_recipe(work: Path) -> None:
    result = run("lock", "cel.yaml")
    assert result.exit_code == 2
    assert "did you mean `cell.yaml`?" in result.stderr
    assert not (work / "cel.lock").exists()


def test_a_recipe_without_sources(work: Path) -> None:
    (work / "cell.yaml").write_text("recipe: 1\nname: empty\n")
    assert run("lock", "cell.yaml").stdout == "  no sources to pin\nwrote cell.lock\n"


def test_what_is_fetched_to_be_extended_is_locked(work: Path) -> None:
    """It need not give a model, nor anything that is left in the end; what it extends itself is locked too."""
    robots = work.parent / "robots"
    commit(
        robots,
        **{
            "slow.yaml": "recipe: 1\nextends: ./dark.yaml\noption: {timestep: 0.004}\n",
            "dark.yaml": "recipe: 1\noption: {timestep: 0.005}\n",
        },
    )
    source = f"git+file://{robots}@main"
    (work / "beside.yaml").write_text(f"recipe: 1\nextends: {source}#slow.yaml\n")
    (work / "cell.yaml").write_text("recipe: 1\nextends: ./beside.yaml\nbase: ./tool.xml\noption: {timestep: 0.001}\n")
    assert run("lock", "cell.yaml").exit_code == 0
    locked = told(work)
    assert set(locked) == {source, "./tool.xml"}  # a recipe beside this one is as free as this one
    assert set(locked[source]["files"]) == {"slow.yaml", "dark.yaml"}  # type: ignore[call-overload]
    assert locked[source]["used_by"] == ["extends"]
    assert run("build", "cell.yaml", "-o", "one/", "--locked").exit_code == 0
    new = commit(robots, **{"dark.yaml": "recipe: 1\noption: {gravity: [0, 0, 0]}\n"})
    assert run("build", "cell.yaml", "-o", "two/", "--locked").exit_code == 0
    assert snapshot(work / "one") == snapshot(work / "two")
    assert f"is now {new[:12]}" in run("lock", "cell.yaml", "--upgrade-source", "extends").stdout
    assert run("build", "cell.yaml", "-o", "two/", "--locked").exit_code == 0
    assert snapshot(work / "one") != snapshot(work / "two")
    read = {each["path"] for each in json.loads((work / "two" / "manifest.json").read_text())["read"]}
    assert read == {"beside.yaml", "cell.yaml", "tool.xml", f"{source}#slow.yaml", f"{source}#dark.yaml"}


def test_what_a_nested_recipe_extends_is_locked(work: Path) -> None:
    (work / "common.yaml").write_text("recipe: 1\nbase: ./tool.xml\n")
    (work / "inner.yaml").write_text("recipe: 1\nextends: ./common.yaml\n")
    (work / "cell.yaml").write_text("recipe: 1\nattach:\n  in: {model: ./inner.yaml}\n")
    assert run("lock", "cell.yaml").exit_code == 0
    used_by = {id: locked["used_by"] for id, locked in told(work).items()}
    assert used_by == {"./common.yaml": ["in/extends"], "./inner.yaml": ["in"], "./tool.xml": ["in/base"]}
    (work / "common.yaml").write_text("recipe: 1\nname: other\nbase: ./tool.xml\n")
    result = run("build", "cell.yaml", "-o", "out/", "--locked")
    assert result.exit_code == 1
    assert "cell.yaml:3:3: error[source-changed]: `./common.yaml` differs from the lock `cell.lock`" in result.stderr
    assert "`common.yaml` changed" in result.stderr


def test_a_part_without_a_prefix_is_locked_by_its_key(work: Path) -> None:
    (work / "inner.yaml").write_text("recipe: 1\nbase: ./arm.xml\n")
    (work / "arm.xml").write_text("<mujoco/>")
    (work / "cell.yaml").write_text("recipe: 1\nattach:\n  bare: {model: ./inner.yaml, prefix: ''}\n")
    assert run("lock", "cell.yaml").exit_code == 0
    used_by = {id: locked["used_by"] for id, locked in told(work).items()}
    assert used_by == {"./inner.yaml": ["bare"], "./arm.xml": ["bare/base"]}


def test_an_extended_recipe_of_the_matrix_is_pinned_too(work: Path) -> None:
    robots = work.parent / "robots"
    commit(robots, **{"all.yaml": "recipe: 1\nvariants: {size: {s: {}, l: {}}}\nmatrix: {axes: {size: [s, l]}}\n"})
    (work / "cell.yaml").write_text(f"recipe: 1\nextends: git+file://{robots}@main#all.yaml\nbase: ./tool.xml\n")
    assert run("lock", "cell.yaml").exit_code == 0
    commit(robots, **{"all.yaml": "recipe: 1\nvariants: {size: {s: {}}}\n"})
    assert run("build", "cell.yaml", "--all", "--locked").exit_code == 0
    assert {path.name for path in (work / "build").glob("*.zip")} == {"cell-s.zip", "cell-l.zip"}


def test_a_lock_has_what_variants_and_cells_choose(work: Path) -> None:
    for name in ("a", "b", "c", "d"):
        (work / f"{name}.xml").write_text(TOOL)
    (work / "cell.yaml").write_text(
        "recipe: 1\nbase: ./tool.xml\nparams: {what: {type: string, default: a}}\n"
        "variants:\n"
        "  tool: {none: {}, b: {attach: {t: {model: ./b.xml}}}}\n"
        "  both: {no: {}, yes: {attach: {u: {model: ./c.xml, when: {tool: b}}}}}\n"
        "  gone: {no: {}, yes: {attach: {v: {model: ./gone.xml}}}}\n"
        "attach: {p: {model: './${what}.xml'}}\n"
        "matrix: {axes: {what: [a, d]}}\n"
    )
    result = run("lock", "cell.yaml")
    assert result.exit_code == 0
    assert set(told(work)) == {"./tool.xml", "./a.xml", "./b.xml", "./c.xml", "./d.xml"}
    assert result.stderr.count("warning[source-not-found]") == 1  # no build that anyone asked for
    chosen = ("--set", "tool=b", "--set", "both=yes", "--locked")
    assert run("build", "cell.yaml", "-o", "out/", *chosen).exit_code == 0
    assert run("build", "cell.yaml", "--all", "--locked").exit_code == 0


def test_update_of_a_part_of_a_nested_recipe(work: Path) -> None:
    old = git(work.parent / "robots", "rev-parse", "HEAD")
    inner = f"recipe: 1\nattach:\n  arm: {{model: git+file://{work.parent}/robots@main#arm/arm.xml}}\n"
    (work / "inner.yaml").write_text(inner)
    (work / "cell.yaml").write_text(
        "recipe: 1\nattach:\n  left: {model: ./inner.yaml}\n  right: {model: ./inner.yaml}\n"
    )
    run("lock", "cell.yaml")
    new = commit(work.parent / "robots", **{"arm/arm.xml": ARM.replace("0.02", "0.03")})
    assert (
        "up to date" in run("lock", "cell.yaml", "--upgrade-source", "left").stdout
    )  # the recipe itself, which is the same
    result = run("lock", "cell.yaml", "--upgrade-source", "left/arm")
    assert f"{old[:12]} is now {new[:12]}" in result.stdout
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0
    assert not (work / "inner.lock").exists()


def test_parts_that_a_fetched_recipe_has_beside_it(work: Path) -> None:
    """They belong to what it was fetched with: here and there a `tool.xml` are two."""
    assert run("build", "cell.yaml", "-o", "out/").exit_code == 0
    manifest = json.loads((work / "out" / "manifest.json").read_text())
    source = f"git+file://{work.parent}/robots@main"
    origins = {(each["path"], each["origin"]["id"] if each["origin"] else None) for each in manifest["inputs"]}
    assert origins == {("arm/arm.xml", source), ("tool.xml", source), ("tool.xml", None)}
    read = {each["path"] for each in manifest["read"]}
    assert {"tool.xml", f"{source}#tool.xml", f"{source}#arm/cell.yaml"} <= read
    assert not any("store" in path for path in read)


def test_a_lock_has_what_draws_choose(work: Path) -> None:
    (work / "other.xml").write_text(TOOL)
    (work / "cell.yaml").write_text(
        "recipe: 1\nbase: ./tool.xml\nparams: {what: {type: string, default: tool}}\n"
        "attach: {p: {model: './${what}.xml'}}\n"
        "randomize: {seed: 1, samples: 8, fields: {w: {param: what, choice: [tool, other]}}}\n"
    )
    assert run("lock", "cell.yaml").exit_code == 0
    assert set(told(work)) == {"./tool.xml", "./other.xml"}


def test_a_branch_and_a_tag_of_one_commit_are_two_sources(work: Path) -> None:
    robots = work.parent / "robots"
    git(robots, "tag", "v1")
    ids = {f"git+file://{robots}@{revision}" for revision in ("main", "v1")}
    main, tag = sorted(ids)
    (work / "cell.yaml").write_text(
        f"recipe: 1\nbase: {main}#arm/arm.xml\nattach:\n  tool: {{model: {tag}#tool.xml, site: flange}}\n"
    )
    assert run("lock", "cell.yaml").exit_code == 0
    assert set(told(work)) == ids
    assert run("build", "cell.yaml", "-o", "out/", "--locked").exit_code == 0


def test_a_matrix_hashes_every_file_once(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from mjcompose.sources import fetching

    (work / "cell.yaml").write_text(
        (work / "cell.yaml").read_text() + "params: {g: 1}\noption: {gravity: [0, 0, '${g}']}\n"
        "matrix: {axes: {g: [1, 2, 3]}}\n"
    )
    assert run("lock", "cell.yaml").exit_code == 0
    hashed: list[Path] = []
    real = fetching.sha256_of
    monkeypatch.setattr(fetching, "sha256_of", lambda path: (hashed.append(path), real(path))[1])
    result = run("build", "cell.yaml", "--all", "--locked", "--no-compile", "-o", "out/{name}.zip")
    assert result.exit_code == 0 and len(list((work / "out").glob("*.zip"))) == 3
    assert hashed and len(hashed) == len(set(hashed))


@pytest.mark.parametrize(("key", "value"), [("tree", "0" * 40), ("kind", "archive"), ("kind", "path"), ("tree", None)])
def test_a_lock_that_contradicts_itself_is_an_error(work: Path, key: str, value: str | None) -> None:
    run("lock", "cell.yaml")
    lock = json.loads((work / "cell.lock").read_text())
    (source,) = [each for each in lock["sources"].values() if each["kind"] == "git"]
    source[key] = value
    (work / "cell.lock").write_text(json.dumps(lock))
    for more in ((), ("--locked",)):
        result = run("build", "cell.yaml", "--no-compile", *more)
        assert result.exit_code == 1
        assert (
            "cell.yaml:2:7: error[lock-invalid]: the lock `cell.lock` contradicts itself about `git+file:"
            in result.stderr
        )
        assert f"  = note: its {key} is `" in result.stderr


@pytest.mark.parametrize("what", ["commit", "tree", "sha256", "package", "version"])
def test_a_file_of_ones_own_has_no_pin(work: Path, what: str) -> None:
    run("lock", "cell.yaml")
    lock = json.loads((work / "cell.lock").read_text())
    source = next(each for each in lock["sources"].values() if each["kind"] == "path")
    source[what] = "0" * (64 if what == "sha256" else 40)
    (work / "cell.lock").write_text(json.dumps(lock))
    result = run("check", "cell.yaml")
    assert (
        result.exit_code == 1 and "error[lock-invalid]: the lock `cell.lock` contradicts itself about" in result.stderr
    )
    assert f"  = note: a source of kind `path` has no {what}\n" in result.stderr


@pytest.mark.parametrize("command", [("build", "--no-compile"), ("build", "--all"), ("plan",), ("check",)])
def test_a_lock_of_other_versions_is_told_to_who_asks_for_it(work: Path, command: tuple[str, ...]) -> None:
    run("lock", "cell.yaml")
    lock = json.loads((work / "cell.lock").read_text())
    for changed in ({"mujoco": "2.3.7"}, {"mujoco": "2.3.7", "mjcompose": "0.0.9"}):
        (work / "cell.lock").write_text(json.dumps({**lock, **changed}))
        assert "lock-stale" not in run(*command, "cell.yaml").stderr
        for _ in range(2):  # the second time it is told from what is kept
            result = run(*command, "cell.yaml", "--locked")
            assert result.exit_code == 0
            assert result.stderr.count("warning[lock-stale]: `cell.lock` was made with ") == 1, result.stderr
        assert "MuJoCo 2.3.7, this is " in result.stderr
    assert "was made with mjcompose 0.0.9 and MuJoCo 2.3.7, this is mjcompose " in result.stderr


def test_another_version_of_a_package_with_the_same_bytes(work: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    site = work.parent / "site"
    (site / "arms").mkdir(parents=True)
    (site / "arms" / "tool.xml").write_text(TOOL)
    (site / "arms-1.0.dist-info").mkdir()
    (site / "arms-1.0.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: arms\nVersion: 1.0\n")
    (site / "arms-1.0.dist-info" / "RECORD").write_text("arms/tool.xml,,\n")
    monkeypatch.syspath_prepend(str(site))
    (work / "cell.yaml").write_text("recipe: 1\nbase: package:arms/tool.xml\n")
    run("lock", "cell.yaml")
    lock = (work / "cell.lock").read_text()
    assert '"version": "1.0"' in lock
    (work / "cell.lock").write_text(lock.replace('"version": "1.0"', '"version": "0.9"'))
    assert "lock-stale" not in run("build", "cell.yaml", "--no-compile").stderr
    result = run("build", "cell.yaml", "--no-compile", "--locked")
    assert result.exit_code == 0
    assert "cell.yaml:2:7: warning[lock-stale]: `package:arms` has the bytes" in result.stderr
    assert "  = note: version 0.9 was locked, and now it is 1.0" in result.stderr


@pytest.mark.parametrize("locked", [False, True])
def test_what_is_fetched_reaches_no_file_of_this_machine(work: Path, locked: bool) -> None:
    """Neither by an absolute path nor by a way out of the repository: such a file is another one elsewhere."""
    robots = work.parent / "robots"
    secret = work.parent / "secret.obj"
    secret.write_text(COVER)
    (work.parent / "secret.xml").write_text(TOOL)
    if locked:
        run("lock", "cell.yaml")
    before = snapshot(work)
    commit(
        robots,
        **{
            "arm/mesh.xml": ARM.replace("cover.obj", str(secret)),
            "arm/far.xml": ARM.replace(
                '"cover.obj"', f'"cover.obj" file="{"../" * 12}{secret.relative_to("/")}"'
            ).replace('file="cover.obj" ', ""),
            "arm/include.xml": f'<mujoco><include file="{work.parent / "secret.xml"}"/></mujoco>',
            "arm/recipe.yaml": f"recipe: 1\nattach: {{x: {{model: {work.parent / 'secret.xml'}}}}}\n",
            "arm/element.yaml": f"recipe: 1\nasset: {{mesh: {{m: {{file: {secret}}}}}}}\n",
        },
    )
    for name in ("mesh.xml", "far.xml", "include.xml", "recipe.yaml", "element.yaml"):
        (work / "evil.yaml").write_text(f"recipe: 1\nattach: {{x: {{model: git+file://{robots}@main#arm/{name}}}}}\n")
        result = run("build", "evil.yaml", "--no-compile", "-o", "out.zip")
        assert result.exit_code == 1, name
        assert "error[source-outside]: " in result.stderr, (name, result.stderr)
        assert not (work / "out.zip").exists()
    (work / "evil.yaml").unlink()
    assert snapshot(work) == before


def test_what_is_written_in_place_is_no_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It stands in the recipe itself, of which anything may change that changes no source."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tool.xml").write_text(TOOL)
    table = "model: {add: [{to: world, body: {name: top, geom: {size: [0.1]}}}]}"
    recipe = f"recipe: 1\nattach:\n  table: {{{table}}}\n  tool: {{model: ./tool.xml, body: table/top}}\n"
    (tmp_path / "cell.yaml").write_text(recipe)
    assert run("lock", "cell.yaml").exit_code == 0
    assert list(json.loads((tmp_path / "cell.lock").read_text())["sources"]) == ["./tool.xml"]
    (tmp_path / "cell.yaml").write_text(recipe.replace("0.1", "0.2"))
    assert run("check", "cell.yaml", "--locked").exit_code == 0
    (tmp_path / "tool.xml").write_text(TOOL + "<!-- new -->")
    assert "error[source-changed]" in run("check", "cell.yaml", "--locked").stderr


def test_a_lock_through_a_link_has_the_names_of_its_own_folder(folder: Path) -> None:
    """As in the sandbox of a build system, which has a link in place of each file."""
    assert run("lock", "cell.yaml").exit_code == 0
    sandbox = folder.parent / "sandbox"
    for path in [*folder.glob("cell.*"), *folder.glob("models/**/*")]:
        if path.is_file():
            (link := sandbox / path.relative_to(folder)).parent.mkdir(parents=True, exist_ok=True)
            link.symlink_to(path)
    assert run("check", str(sandbox / "cell.yaml"), "--locked").exit_code == 0
    (folder / "models" / "tool.xml").write_text(TOOL.replace("0.03", "0.04"))
    assert "error[source-changed]" in run("check", str(sandbox / "cell.yaml"), "--locked").stderr
