"""The build cache as its users see it: the same bytes and the same words, sooner; and never a wrong or a half one."""

from __future__ import annotations

import os
import re
import signal
import stat
import subprocess
import sys
import time
import zipfile
from itertools import product
from pathlib import Path

import pytest
from cli.shell import environment, process, run, snapshot
from mjcompose.base.diagnostic import Diagnostic, Note, Severity, Span
from mjcompose.bundle.bundle import CheckOutcome
from mjcompose.pipeline.cache.cache import Record, from_json, to_json
from sampling import rest_slow


def built(*arguments: str) -> tuple[list[str], list[str]]:
    """What was built, and what was not, with the reasons that `--why` gives."""
    result = run("build", *arguments, "--why")
    assert result.exit_code == 0, result.stderr
    return (
        re.findall(r"^  built: (.*)$", result.stdout, re.MULTILINE),
        re.findall(r"^  not built again: (.*)$", result.stdout, re.MULTILINE),
    )


# -- the same bytes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("out", "more"), [("x.zip", ()), ("x/", ()), ("x.xml", ("--no-compile",)), ("x.zip", ("--dedup", "--no-compile"))]
)
def test_the_bytes_are_those_of_a_build_without_cache(
    store: Path, folder: Path, out: str, more: tuple[str, ...]
) -> None:
    for name in ("without", "first", "again"):
        (folder / name).mkdir()
        target = f"{name}/{out}"
        assert (
            run("build", "cell.yaml", "-o", target, *more, *(["--no-cache"] if name == "without" else [])).exit_code
            == 0
        )
    assert snapshot(folder / "without") == snapshot(folder / "first") == snapshot(folder / "again")


def test_a_zip_of_what_was_built_as_a_folder_and_the_other_way(store: Path, folder: Path) -> None:
    run("build", "cell.yaml", "-o", "first/", "--no-cache")
    run("build", "cell.yaml", "-o", "first.zip", "--no-cache")
    run("build", "cell.yaml", "-o", "other/")
    assert built("cell.yaml", "-o", "other.zip")[0] == []
    assert (folder / "other.zip").read_bytes() == (folder / "first.zip").read_bytes()
    assert snapshot(folder / "other") == snapshot(folder / "first")


def test_text_names_its_files_from_where_it_is(store: Path, folder: Path) -> None:
    run("build", "cell.yaml", "-o", "a.xml")
    run("build", "cell.yaml", "-o", "deeper/a.xml")
    assert 'file="models/meshes/cover.obj"' in (folder / "a.xml").read_text()
    assert 'file="../models/meshes/cover.obj"' in (folder / "deeper" / "a.xml").read_text()
    assert run("build", "cell.yaml", "-o", "-").stdout == run("build", "cell.yaml", "-o", "-").stdout


def test_source_date_epoch_is_no_part_of_what_is_known(
    store: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run("build", "cell.yaml", "-o", "a.zip")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    run("build", "cell.yaml", "-o", "b.zip", "--no-cache")
    assert built("cell.yaml", "-o", "a.zip")[0] == []
    assert (folder / "a.zip").read_bytes() == (folder / "b.zip").read_bytes()


# -- the same words ------------------------------------------------------------------------------------------


def test_warnings_are_told_again(store: Path, folder: Path) -> None:
    (folder / "other.xml").write_text('<mujoco><option timestep="0.001"/><worldbody/></mujoco>')
    (folder / "w.yaml").write_text(
        "recipe: 1\nconflict: base\nbase: ./models/arm.xml\noption: {gravity: [0, 0, -9.81]}\n"
        "attach:\n  other: {model: ./other.xml}\n"
    )
    first = run("build", "w.yaml", "-o", "w.zip")
    assert "warning" in first.stderr
    again = run("build", "w.yaml", "-o", "w.zip")
    assert again.stderr == first.stderr
    assert "up to date" in again.stdout
    (folder / "w.yaml").write_text("# everything one line lower\n" + (folder / "w.yaml").read_text())
    moved = run("build", "w.yaml", "-o", "w.zip")
    assert moved.stderr == run("build", "w.yaml", "-o", "w.zip", "--no-cache").stderr


@pytest.mark.slow
def test_check_tells_its_checks_again(store: Path, folder: Path) -> None:
    first = run("check", "matrix.yaml", "--junit", "-")
    assert 'name="heavy"' in first.stdout
    assert run("check", "matrix.yaml", "--junit", "-").stdout == first.stdout
    (folder / "matrix.yaml").write_text("#\n" + (folder / "matrix.yaml").read_text())
    lower = run("check", "matrix.yaml", "--junit", "-")
    assert lower.stdout == run("check", "matrix.yaml", "--junit", "-", "--no-cache").stdout != first.stdout


def test_faults_are_found_each_time(store: Path, folder: Path) -> None:
    first = run("build", "rejected.yaml")
    assert first.exit_code == 1
    again = run("build", "rejected.yaml")
    assert (again.exit_code, again.stderr) == (1, first.stderr)
    assert run("build", "cell.yaml", "--set-file", "none.yaml").exit_code == 2


def test_known_models_need_no_heavy_library(store: Path, folder: Path) -> None:
    assert process("build", "cell.yaml", "-o", "a.zip").returncode == 0
    tell = (
        "import atexit, sys; sys.argv = ['mjcompose', 'build', 'cell.yaml', '-o', 'b.zip']\n"
        "atexit.register(lambda: print([n for n in ('numpy', 'pydantic', 'lxml', 'yaml', 'click') if n in sys.modules]))\n"
        "from mjcompose.cli.main import main; main()"
    )
    done = subprocess.run([sys.executable, "-c", tell], env=environment(), capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "['click']"


# -- what is built again, and why ----------------------------------------------------------------------------


def test_why(store: Path, folder: Path) -> None:
    out = ("cell.yaml", "-o", "a.zip")
    assert built(*out)[0] == ["it was not built before, or its result was not kept"]
    assert built(*out) == ([], ["nothing that it depends on changed"])
    mesh = folder / "models" / "meshes" / "cover.obj"
    before = mesh.read_text()
    mesh.write_text(before.replace("v 0 0 1", "v 0 0 2"))
    assert built(*out)[0] == ["`models/meshes/cover.obj` changed"]
    mesh.write_text(before)
    assert built(*out)[0] == []  # as it was before
    (folder / "models" / "NOTICE").write_text("more\n")
    assert built(*out)[0] == ["the licenses in `models` differ"]
    assert built(*out, "--dedup")[0] == ["`--dedup` is given"]
    assert run("build", *out, "--no-cache", "--why").stdout.splitlines()[2] == "  built: the cache is not used"


def test_why_of_the_first_license_of_a_folder(store: Path, folder: Path) -> None:
    (folder / "here").mkdir()
    (folder / "here" / "cell.yaml").write_text("recipe: 1\nbase: ./arm.xml\n")
    (folder / "here" / "arm.xml").write_text("<mujoco><worldbody/></mujoco>")
    out = ("here/cell.yaml", "-o", "a.zip")
    built(*out)
    (folder / "LICENSE").write_text("Do as you please.\n")
    assert built(*out)[0] == ["the licenses in `.` differ"]
    (folder / "LICENSE").rename(folder / "here" / "LICENSE")
    assert built(*out)[0][1:] == ["the licenses in `here` differ", "the licenses in `.` differ"]


def test_why_of_a_license_as_far_above_as_licenses_are_looked_for(store: Path, folder: Path) -> None:
    deep = folder / "a" / "b" / "c"
    deep.mkdir(parents=True)
    (deep / "arm.xml").write_text("<mujoco><worldbody/></mujoco>")
    (folder / "far.yaml").write_text("recipe: 1\nbase: ./a/b/c/arm.xml\n")
    out = ("far.yaml", "-o", "a.zip")
    built(*out)
    (folder / "LICENSE").write_text("Do as you please.\n")
    assert built(*out)[0] == ["the licenses in `.` differ"]


@pytest.mark.slow
def test_why_of_a_license_in_a_folder_of_licenses(store: Path, folder: Path) -> None:
    (folder / "models" / "LICENSES" / "arm").mkdir(parents=True)
    (folder / "models" / "LICENSES" / "MIT.txt").write_text("free\n")
    out = ("cell.yaml", "-o", "a.zip")
    built(*out)
    (folder / "models" / "LICENSES" / "Zlib.txt").write_text("altered\n")
    assert built(*out)[0] == ["the licenses in `models/LICENSES` differ"]
    assert built(*out)[0] == []
    (folder / "models" / "LICENSES" / "arm" / "LICENSE").write_text("mine\n")
    assert built(*out)[0] == ["the licenses in `models/LICENSES/arm` differ"]
    (folder / "models" / "LICENSES" / "MIT.txt").write_text("freer\n")
    assert built(*out)[0] == ["`models/LICENSES/MIT.txt` changed"]


@pytest.mark.slow
def test_files_of_values_in_another_order_are_another_model(store: Path, folder: Path) -> None:
    (folder / "two.yaml").write_text("load: 2\n")
    (folder / "three.yaml").write_text("load: 3\n")
    built("matrix.yaml", "-o", "a.zip", "--set-file", "two.yaml", "--set-file", "three.yaml")
    why, _ = built("matrix.yaml", "-o", "b.zip", "--set-file", "three.yaml", "--set-file", "two.yaml")
    assert why == ["the order of `--set-file` was two.yaml, three.yaml, is three.yaml, two.yaml"]
    assert run("build", "matrix.yaml", "-o", "c.zip", "--no-cache", "--set", "load=2").exit_code == 0
    models = [zipfile.ZipFile(folder / name).read("model.xml") for name in ("b.zip", "c.zip")]
    assert models[0] == models[1]


def test_why_of_a_parameter(store: Path) -> None:
    out = ("matrix.yaml", "-o", "a.zip")
    built(*out, "--set", "load=2")
    assert built(*out, "--set", "load=3")[0] == ["`load` was 2, is 3"]
    assert built(*out, "--set", "load=3", "--set", "tool=palm")[0] == ["`tool` is palm"]


@pytest.mark.slow
def test_why_of_a_file_of_values(store: Path, folder: Path) -> None:
    file = folder / "values.yaml"
    file.write_text("load: 2\n")
    out = ("matrix.yaml", "-o", "a.zip")
    built(*out)
    assert built(*out, "--set-file", "values.yaml")[0] == ["`--set-file values.yaml` is given"]
    file.write_text("load: 3\ntool: palm\n")
    assert built(*out, "--set-file", "values.yaml")[0] == [
        "`load` in `values.yaml` was 2, is 3",
        "`tool` in `values.yaml` is palm, is new",
    ]
    file.write_text("load: 3\ntool: palm\n" + "# more\n" * 10_000)
    assert built(*out, "--set-file", "values.yaml")[1] == ["the recipe changed, but nothing that this model uses"]
    file.write_text("load: 4\n")
    assert built(*out, "--set-file", "values.yaml")[0] == [
        "`values.yaml` changed, but it is unknown which of its values"
    ]
    assert built("matrix.yaml", "-o", "b.zip", "--set", "load=5")[0] == [
        "`--set-file values.yaml` is no longer given",
        "`load` is 5",
    ]


def test_a_touched_file_is_the_same(store: Path, folder: Path) -> None:
    built("cell.yaml", "-o", "a.zip")
    os.utime(folder / "models" / "arm.xml", (0, 0))
    assert built("cell.yaml", "-o", "a.zip")[0] == []


def test_an_included_file_counts(store: Path, folder: Path) -> None:
    (folder / "models" / "inner.xml").write_text('<mujoco><worldbody><geom name="g" size="1"/></worldbody></mujoco>')
    arm = folder / "models" / "arm.xml"
    arm.write_text(arm.read_text().replace("<asset>", '<include file="inner.xml"/><asset>'))
    built("cell.yaml", "-o", "a.zip")
    (folder / "models" / "inner.xml").write_text('<mujoco><worldbody><geom name="g" size="2"/></worldbody></mujoco>')
    assert built("cell.yaml", "-o", "a.zip")[0] == ["`models/inner.xml` changed"]


@pytest.mark.slow
def test_an_extended_and_a_nested_recipe_count(store: Path, folder: Path) -> None:
    (folder / "upper.yaml").write_text("extends: ./cell.yaml\nname: upper\n")
    (folder / "outer.yaml").write_text("recipe: 1\nattach:\n  a: {model: ./upper.yaml}\n")
    built("outer.yaml", "-o", "a.zip")
    cell = folder / "cell.yaml"
    cell.write_text(cell.read_text().replace("angle:", "angles:"))
    assert built("outer.yaml", "-o", "a.zip")[0] == ["`cell.yaml` changed"]
    run("build", "outer.yaml", "-o", "b.zip", "--no-cache")
    assert (folder / "a.zip").read_bytes() == (folder / "b.zip").read_bytes()


def test_of_two_equal_recipes_one_gets_a_comment(store: Path, folder: Path) -> None:
    for name in ("left", "right"):
        (folder / f"{name}.yaml").write_text("recipe: 1\nname: arm\nbase: ./models/arm.xml\n")
    (folder / "outer.yaml").write_text("recipe: 1\nattach:\n  a: {model: ./left.yaml}\n  b: {model: ./right.yaml}\n")
    built("outer.yaml", "-o", "a.zip", "--no-compile")
    with (folder / "left.yaml").open("a") as left:
        left.write("# no longer equal\n")
    assert built("outer.yaml", "-o", "a.zip", "--no-compile")[0] == []
    run("build", "outer.yaml", "-o", "b.zip", "--no-compile", "--no-cache")
    assert (folder / "a.zip").read_bytes() == (folder / "b.zip").read_bytes()


def test_another_version_of_the_code(store: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    built("cell.yaml", "-o", "a.zip")
    monkeypatch.setattr("mjcompose.pipeline.cache.cache_key.tool_version", lambda store: "9.9")
    (line,) = built("cell.yaml", "-o", "a.zip")[0]
    assert line.startswith("mjcompose was ")
    assert line.endswith(", is 9.9")


def test_an_output_that_is_gone_or_changed_is_written_again(store: Path, folder: Path) -> None:
    run("build", "cell.yaml", "-o", "x/")
    whole = snapshot(folder / "x")
    (folder / "x" / "model.xml").write_text("<mujoco/>")
    assert "wrote x/" in run("build", "cell.yaml", "-o", "x/").stdout
    assert snapshot(folder / "x") == whole
    (folder / "x" / "assets" / "arm" / "cover.obj").unlink()
    run("build", "cell.yaml", "-o", "x/")
    assert snapshot(folder / "x") == whole


def test_a_known_model_takes_the_place_of_no_source(store: Path, folder: Path) -> None:
    run("build", "cell.yaml", "-o", "a.xml")
    result = run("build", "cell.yaml", "-o", "models/arm.xml")
    assert result.exit_code == 1
    assert "is one of the files that this model is built from" in result.stderr
    again = run("build", "cell.yaml", "-o", "models/")
    assert again.exit_code == 1


# -- cells ---------------------------------------------------------------------------------------------------


@pytest.mark.slow
def test_only_the_cells_that_a_change_concerns(store: Path, folder: Path) -> None:
    out = ("matrix.yaml", "--all", "-o", "b/{name}.zip")
    assert len(built(*out)[0]) == 4
    assert built(*out)[0] == []
    recipe = folder / "matrix.yaml"
    recipe.write_text(recipe.read_text().replace("site: flange}", "site: flange, pos: [0, 0, 0.1]}"))
    new, known = built(*out)
    assert new == ["`matrix.yaml` changed"] * 2
    assert known == ["the recipe changed, but nothing that this model uses"] * 2
    recipe.write_text(recipe.read_text() + "# a line more\n")
    assert built(*out)[0] == []
    recipe.write_text("# now the check stands one line lower, and the manifests say where\n" + recipe.read_text())
    assert len(built(*out)[0]) == 4
    run("build", "matrix.yaml", "--all", "-o", "c/{name}.zip", "--no-cache")
    assert snapshot(folder / "b") == snapshot(folder / "c")


def test_a_second_run_writes_what_is_missing(store: Path, folder: Path) -> None:
    out = ("build", "matrix.yaml", "--all", "-o", "b/{name}.zip")
    run(*out)
    (folder / "b" / "cell-palm-2.0.zip").unlink()
    said = run(*out).stdout
    assert said.count("is up to date") == 3
    assert "wrote b/cell-palm-2.0.zip" in said


def test_an_interruption_leaves_whole_models_and_says_how_to_go_on(
    store: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from mjcompose.cli import build_cells

    put = build_cells.put

    def interrupted(made: object, *rest: object, **named: object) -> object:
        if getattr(made, "name", "") == "cell-palm-1.0":
            raise KeyboardInterrupt
        return put(made, *rest, **named)  # type: ignore[arg-type]

    monkeypatch.setattr(build_cells, "put", interrupted)
    result = run("build", "matrix.yaml", "--all", "-o", "b/{name}.zip")
    assert result.exit_code == 130
    assert "2 of 4 are written and whole" in result.stderr
    assert "`mjcompose build matrix.yaml --all -o 'b/{name}.zip'` builds the rest" in result.stderr
    assert sorted(os.listdir(folder / "b")) == ["cell-none-1.0.zip", "cell-none-2.0.zip", "models.csv"]


# -- a store that is damaged, full, of somebody else, or in use ----------------------------------------------


DAMAGES = list(product(["cut", "flipped", "gone"], ["asked", "built", "raw", "packed"]))


@pytest.mark.parametrize("harm", rest_slow(DAMAGES, ["cut-asked", "flipped-built", "gone-packed"], "-".join))
def test_what_is_damaged_is_built_again(store: Path, folder: Path, harm: tuple[str, str]) -> None:
    damage, kind = harm
    run("build", "cell.yaml", "-o", "a.zip")
    for path in (store / kind).iterdir():
        content = path.read_bytes()
        if damage == "gone":
            path.unlink()
        elif damage == "cut":
            path.write_bytes(content[:-5])
        else:
            path.write_bytes(content[:-1] + bytes([content[-1] ^ 1]))
    whole = (folder / "a.zip").read_bytes()
    assert run("build", "cell.yaml", "-o", "b.zip").exit_code == 0
    assert (folder / "b.zip").read_bytes() == whole
    assert built("cell.yaml", "-o", "c.zip")[0] == []


def test_verify_finds_what_is_damaged(store: Path, folder: Path) -> None:
    run("build", "cell.yaml", "-o", "a.zip")
    path = next((store / "packed").iterdir())
    path.write_bytes(path.read_bytes()[:-1])
    assert f"removed {path}: it was damaged" in run("cache", "verify").stdout
    assert not path.exists()


def test_the_store_is_kept_below_its_bound(store: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MJCOMPOSE_CACHE_SIZE", "2K")
    run("build", "cell.yaml", "-o", "a.zip")
    sizes = [path.stat().st_size for kind in ("asked", "built", "raw", "packed") for path in (store / kind).iterdir()]
    assert sum(sizes) <= 2048
    assert run("build", "cell.yaml", "-o", "b.zip").exit_code == 0


def test_a_store_that_cannot_be_written(store: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store.write_text("a file where the folder should be")
    result = run("build", "matrix.yaml", "--all", "-o", "b/{name}.zip")
    assert result.exit_code == 0
    assert result.stderr.count("warning[store-unusable]: the built model is not kept in") == 1
    assert len(list((folder / "b").glob("*.zip"))) == 4


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="who runs this may write everywhere")
def test_a_store_that_may_only_be_read(store: Path, folder: Path) -> None:
    run("build", "cell.yaml", "-o", "a.zip")
    for path in (store, *store.rglob("*")):
        path.chmod(path.stat().st_mode & ~(stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH))
    assert built("cell.yaml", "-o", "a.zip")[0] == []
    assert run("build", "matrix.yaml", "-o", "b.zip").stderr.count("store-unusable") == 1


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no limits of resources")
def test_a_full_disk(store: Path, folder: Path) -> None:
    """No file may be larger than what the output needs: what is kept in the store for it is refused, and told once."""
    cover = folder / "models" / "meshes" / "cover.obj"
    cover.write_text(cover.read_text() + "".join(f"v {number} {number * 7919 % 1000} 0\n" for number in range(20)))
    script = (
        "import resource, signal, errno, mjcompose.sources.blobs as blobs\n"
        "real = blobs.put\n"
        "def full(store, kind, key, content):\n"
        "    soft = resource.getrlimit(resource.RLIMIT_FSIZE)\n"
        "    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
        "    resource.setrlimit(resource.RLIMIT_FSIZE, (64, soft[1]))\n"
        "    try: real(store, kind, key, content)\n"
        "    finally: resource.setrlimit(resource.RLIMIT_FSIZE, soft)\n"
        "blobs.put = full\n"
        "import sys; sys.argv = ['mjcompose', 'build', 'cell.yaml', '-o', 'a.zip']\n"
        "from mjcompose.cli.main import main; main()"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], env=environment(), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("warning[store-unusable]") == 1
    assert (folder / "a.zip").is_file()
    assert os.listdir(store / "writing") == []
    assert built("cell.yaml", "-o", "b.zip")[0] != []
    assert (folder / "a.zip").read_bytes() == (folder / "b.zip").read_bytes()


@pytest.mark.slow
def test_two_processes_at_once(store: Path, folder: Path) -> None:
    command = [sys.executable, "-m", "mjcompose", "build", "matrix.yaml", "--all", "-o"]
    running = [
        subprocess.Popen(
            [*command, f"{name}/{{name}}.zip"], env=environment(), stderr=subprocess.PIPE, stdout=subprocess.DEVNULL
        )
        for name in ("a", "b", "a")
    ]
    for each in running:
        told = each.communicate(timeout=120)[1]
        assert b"warning" not in told
        assert b"error" not in told
        assert each.returncode == 0
    run("build", "matrix.yaml", "--all", "-o", "c/{name}.zip", "--no-cache")
    assert snapshot(folder / "a") == snapshot(folder / "b") == snapshot(folder / "c")
    assert run("cache", "verify").stdout.startswith("looked at ")


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no kill -9")
def test_killed_at_any_moment(store: Path, folder: Path) -> None:
    """Whatever the kill left behind, what is told as known is whole: the bytes are those of a build without cache."""
    run("build", "matrix.yaml", "--all", "-o", "c/{name}.zip", "--no-cache")
    command = [sys.executable, "-m", "mjcompose", "build", "matrix.yaml", "--all", "-o", "b/{name}.zip"]
    for wanted in (0, 1, 2, 3):
        running = subprocess.Popen(command, env=environment(), stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        while running.poll() is None and len(list((folder / "b").glob("*.zip"))) < wanted:
            time.sleep(0.002)
        running.send_signal(signal.SIGKILL)
        running.wait()
        for path in (folder / "b").glob("*.zip"):
            assert path.read_bytes() == (folder / "c" / path.name).read_bytes()
    assert process(*command[3:]).returncode == 0
    whole = {path.name: path.read_bytes() for path in (folder / "b").glob("*.zip")}
    assert whole == {path.name: path.read_bytes() for path in (folder / "c").glob("*.zip")}
    assert "damaged" not in run("cache", "verify").stdout


SPAN = Span("cell.yaml", 1, 2, 3, 4)
WARNING = Diagnostic(
    "lock-stale",
    "`tool` is not in the lock",
    SPAN,
    Severity.WARNING,
    (Note("a note", SPAN),),
    "a help",
    (Note("more"),),
    subjects=frozenset({"tool", "arm"}),
)
RECORD = Record(
    name="cell",
    model="model.xml",
    sha256="0" * 64,
    sizes=None,
    merged={},
    files=(),
    text=None,
    mujoco=None,
    licenses=(),
    diagnostics=(WARNING,),
    checks=(CheckOutcome("upright", "stable", SPAN, (WARNING,), {}),),
    draws=None,
    recipes=(),
    places="",
    mentions_positions=False,
    cells=0,
    cells_at=None,
)


def test_what_is_kept_of_a_build_is_read_as_it_was_written() -> None:
    read = from_json(to_json(RECORD))
    assert read == RECORD
    assert read.diagnostics[0].subjects == WARNING.subjects
