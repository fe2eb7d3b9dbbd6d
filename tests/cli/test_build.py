from __future__ import annotations

import json
import os
import signal
import sys
import zipfile
from pathlib import Path

import mujoco
import pytest
from cli.shell import RECIPE, process, run, snapshot
from mjcompose.bundle import write

MODEL_FILES = {"model.xml", "assets/arm/cover.obj", "LICENSES/arm/LICENSE", "manifest.json"}


def names_in(file: Path) -> set[str]:
    with zipfile.ZipFile(file) as bundle:
        return set(bundle.namelist())


# -- where the output goes -----------------------------------------------------------------------------------


def test_default_output_is_named_after_the_model(folder: Path) -> None:
    result = run("build", "cell.yaml", "--no-compile")
    assert result.exit_code == 0
    assert names_in(folder / "build" / "cell.zip") == MODEL_FILES
    assert "wrote build/cell.zip" in result.stdout
    assert result.stderr == ""


@pytest.mark.parametrize("name", ["../outside", "a/b", "..", "a b", "é"])
def test_default_output_stays_in_its_folder(folder: Path, name: str) -> None:
    (folder / "odd.yaml").write_text(RECIPE.replace("name: cell", f'name: "{name}"'), encoding="utf-8")
    assert run("build", "odd.yaml", "--no-compile").exit_code == 0
    (written,) = (folder / "build").iterdir()
    assert written.suffix == ".zip" and names_in(written) == MODEL_FILES
    assert not (folder.parent / "outside.zip").exists()


@pytest.mark.parametrize("out", ["out/", "out", "deep/er/out/"])
def test_folder(folder: Path, out: str) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", out).exit_code == 0
    written = {name for name, content in snapshot(folder / out).items() if content is not None}
    assert written == MODEL_FILES


@pytest.mark.parametrize("out", ["cell.zip", "cell.mjz", "CELL.ZIP", "sub/cell.zip"])
def test_archive_opens_in_mujoco(folder: Path, out: str) -> None:
    result = run("build", "cell.yaml", "-o", out)
    assert result.exit_code == 0, result.stderr
    assert names_in(folder / out) == MODEL_FILES
    assert "cell: nq 1, nv 1, nu 0, 3 bodies, 1 sensor, 0 keyframes" in result.stdout
    if hasattr(mujoco.MjSpec, "from_zip"):
        model = mujoco.MjSpec.from_zip(str(folder / out)).compile()
        assert model.body("tool/palm").id > 0 and model.nmesh == 1


def test_text_names_the_files_where_they_are(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", "out/cell.xml").exit_code == 0
    assert set(snapshot(folder / "out")) == {"cell.xml"}
    monkeypatch.chdir("/")
    model = mujoco.MjModel.from_xml_path(str(folder / "out" / "cell.xml"))
    assert model.nmesh == 1


def test_text_on_standard_output(folder: Path) -> None:
    before = snapshot(folder)
    result = run("build", "cell.yaml", "--no-compile", "-o", "-")
    assert result.exit_code == 0 and result.stderr == ""
    assert result.stdout.startswith('<mujoco model="cell">') and result.stdout.endswith("</mujoco>\n")
    model = mujoco.MjModel.from_xml_string(result.stdout)  # from the folder that the text is printed in
    assert model.nmesh == 1
    assert snapshot(folder) == before


def test_warnings_stay_out_of_the_text(folder: Path) -> None:
    text = RECIPE.replace("name: cell", "conflict: mujoco")
    for name, step in (("arm.xml", "0.002"), ("tool.xml", "0.001")):
        model = folder / "models" / name
        model.write_text(model.read_text().replace("<worldbody>", f'<option timestep="{step}"/>\n<worldbody>'))
    (folder / "cell.yaml").write_text(text)
    for form in ("text", "json", "github"):
        result = run("build", "cell.yaml", "--no-compile", "-o", "-", "--output-format", form)
        assert result.exit_code == 0
        assert result.stdout.startswith("<mujoco") and result.stdout.endswith("</mujoco>\n")
        assert "option-conflict" in result.stderr


def test_mjb(folder: Path) -> None:
    result = run("build", "cell.yaml", "--no-compile", "-o", "cell.mjb")
    assert result.exit_code == 0 and result.stdout.startswith("wrote cell.mjb and cell.manifest.json\n")
    compiled = folder / "cell.mjb"  # exactly what was named, for make and its like
    assert mujoco.MjModel.from_binary_path(str(compiled)).nmesh == 1
    manifest = json.loads(compiled.with_suffix(".manifest.json").read_text())
    assert [each["path"] for each in manifest["files"]] == [compiled.name]


def test_the_name_of_an_mjb_says_where_the_version_goes(folder: Path) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", "v{mujoco}/cell.mjb").exit_code == 0
    assert (folder / f"v{mujoco.__version__}" / "cell.mjb").is_file()


def test_licenses_are_shown(folder: Path) -> None:
    done = run("build", "cell.yaml", "--licenses")
    assert done.exit_code == 0 and "license-missing" not in done.stderr
    rows = [line.split() for line in done.stdout.splitlines()[-3:]]
    assert rows[0] == ["part", "source", "license", "file"]
    assert rows[1][1:] == ["./models/arm.xml", "unknown", "models/LICENSE"]


def test_a_recipe_without_parts_has_no_licenses_to_show(folder: Path) -> None:
    (folder / "scene.yaml").write_text("recipe: 1\nname: scene\n")
    for _ in "ab":  # built, and found built
        assert "no licenses" in run("build", "scene.yaml", "--licenses").stdout


def test_parts_without_a_license_are_told_at_once(folder: Path) -> None:
    (folder / "models" / "LICENSE").unlink()
    done = run("build", "cell.yaml")
    assert done.exit_code == 0
    assert done.stderr.count("license-missing") == 1 and "`arm`, `tool`" in done.stderr
    (folder / "models" / "LICENSE").write_text("\n")
    done = run("build", "cell.yaml", "--licenses")
    assert done.stderr.count("license-missing") == 1 and "models/LICENSE" not in done.stdout
    (folder / "models" / "LICENSE").write_text("Do as you please.\n")
    assert "license" not in run("build", "cell.yaml").stderr
    (folder / "models" / "LICENSE").unlink()
    for name in ("arm", "tool"):
        model = folder / "models" / f"{name}.xml"
        model.write_text("<!-- SPDX-License-Identifier: CC0-1.0 -->\n" + model.read_text())
    assert "license" not in run("build", "cell.yaml").stderr


def test_recipe_and_output_anywhere(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    assert run("build", "../cell/cell.yaml", "--no-compile", "-o", str(tmp_path / "a.zip")).exit_code == 0
    assert run("build", str(folder / "cell.yaml"), "--no-compile", "-o", "../b.zip").exit_code == 0
    assert (tmp_path / "a.zip").read_bytes() == (tmp_path / "b.zip").read_bytes()
    assert list(elsewhere.iterdir()) == []


@pytest.mark.parametrize(
    "out", ["models/arm.xml", "models/", "models", ".", "..", "/", "../cell/models/tool.xml", "linked.xml"]
)
def test_an_output_is_never_one_of_the_sources(folder: Path, out: str) -> None:
    (folder / "linked.xml").symlink_to("models/tool.xml")
    before = snapshot(folder)
    result = run("build", "cell.yaml", "--no-compile", "-o", out)
    assert result.exit_code == 1
    assert "error[output-unwritable]" in result.stderr and "= help: " in result.stderr
    assert snapshot(folder) == before


def test_a_folder_that_the_recipe_itself_uses_is_not_replaced(folder: Path) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", "out/").exit_code == 0
    (folder / "again.yaml").write_text("recipe: 1\nbase: ./out/model.xml\n")
    before = snapshot(folder)
    result = run("build", "again.yaml", "--no-compile", "-o", "out/")
    assert result.exit_code == 1 and "such as `model.xml`" in result.stderr
    assert snapshot(folder) == before


def test_an_output_needs_a_name(folder: Path) -> None:
    result = run("build", "cell.yaml", "-o", "")
    assert result.exit_code == 2 and "error[output-kind]: the output has no name" in result.stderr
    assert not (folder / "build").exists()


@pytest.mark.parametrize("out", ["{nam}.zip", "{names}/", "{mujoco}.zip", "{name}/{version}.mjb"])
def test_braces_that_stand_for_nothing(folder: Path, out: str) -> None:
    result = run("build", "cell.yaml", "-o", out)
    assert result.exit_code == 2 and "has no meaning in the output" in result.stderr
    assert list(folder.glob("*{*")) == []


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere file names are text")
def test_a_path_that_is_not_text(folder: Path) -> None:
    odd = os.fsdecode(b"caf\xe9")
    (folder / "models").rename(folder / odd)
    (folder / "models").mkdir()
    (folder / odd / "cell.yaml").write_text(RECIPE.replace("./models/", "./"))
    assert run("build", f"{odd}/cell.yaml", "--no-compile", "-o", "cell.zip").exit_code == 0
    result = run("build", f"{odd}/cell.yaml", "--no-compile", "-o", "cell.xml")
    assert result.exit_code == 1 and "error[output-kind]" in result.stderr
    assert run("new", f"{odd}.yaml").exit_code == 0
    assert run("build", f"{odd}.yaml", "--no-compile", "-o", "new.zip").exit_code == 0


# -- exit codes and what is told -----------------------------------------------------------------------------


def test_what_was_built_as_json(folder: Path) -> None:
    result = run("build", "cell.yaml", "-o", "cell.zip", "--output-format", "json")
    assert result.exit_code == 0
    (line,) = result.stdout.splitlines()
    told = json.loads(line)
    assert told["output"] == "cell.zip" and told["name"] == "cell"
    assert len(told["sha256"]) == 64 and told["sizes"]["nbody"] == 4


@pytest.mark.parametrize(("recipe", "code"), [("wrong.yaml", 1), ("rejected.yaml", 1), ("nowhere.yaml", 2)])
def test_findings(folder: Path, recipe: str, code: int) -> None:
    before = snapshot(folder)
    result = run("build", recipe, "-o", "out.zip")
    assert result.exit_code == code
    assert result.stdout == ""
    assert result.stderr.endswith("1 error\n")
    assert snapshot(folder) == before


def test_a_rejected_model_is_told_at_its_line(folder: Path) -> None:
    result = run("build", "rejected.yaml", "-o", "out.zip")
    assert result.stderr.startswith("rejected.yaml:9:40: error[mujoco-rejects]: ")
    assert run("build", "rejected.yaml", "-o", "out.zip", "--no-compile").exit_code == 0


def test_usage(folder: Path) -> None:
    before = snapshot(folder)
    result = run("build", "cell.yaml", "-o", "out.foo")
    assert result.exit_code == 2 and "error[output-kind]" in result.stderr
    assert run("build").exit_code == 2
    assert run("build", "cell.yaml", "--timeout", "0").exit_code == 2
    assert run("build", "cell.yaml", "--output-format", "xml").exit_code == 2
    assert snapshot(folder) == before


def test_a_timeout_is_told(folder: Path) -> None:
    result = run("build", "cell.yaml", "-o", "out.zip", "--timeout", "0.0001")
    assert result.exit_code == 1 and "error[mujoco-timeout]" in result.stderr
    assert not (folder / "out.zip").exists()


# -- outputs that cannot be written --------------------------------------------------------------------------


@pytest.mark.parametrize(
    "out", ["cell.yaml/out.zip", "cell.yaml/out/", "/proc/none/out.zip", "x" * 300 + ".zip", "models.zip"]
)
def test_unwritable_output(folder: Path, out: str) -> None:
    (folder / "models.zip").mkdir()
    (folder / "models.zip" / "mine").write_text("mine")
    before = snapshot(folder)
    result = run("build", "cell.yaml", "--no-compile", "-o", out)
    assert result.exit_code == 1
    assert "error[output-unwritable]" in result.stderr
    assert snapshot(folder) == before


def test_read_only_folder(folder: Path) -> None:
    (folder / "closed").mkdir(mode=0o500)
    if os.access(folder / "closed", os.W_OK):
        pytest.skip("who runs this may write everywhere")
    result = run("build", "cell.yaml", "--no-compile", "-o", "closed/out.zip")
    assert result.exit_code == 1 and "permission denied" in result.stderr


@pytest.mark.parametrize("out", ["out.zip", "out/", "out.xml"])
def test_an_output_stays_as_it_was_when_a_build_fails(folder: Path, out: str) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", out).exit_code == 0
    before = snapshot(folder)
    assert run("build", "wrong.yaml", "-o", out).exit_code == 1
    assert run("build", "rejected.yaml", "-o", out).exit_code == 1
    assert snapshot(folder) == before


def test_a_folder_with_other_files_is_not_replaced(folder: Path) -> None:
    assert run("build", "cell.yaml", "--no-compile", "-o", "out/").exit_code == 0
    (folder / "out" / "notes.txt").write_text("mine")
    before = snapshot(folder)
    result = run("build", "cell.yaml", "--no-compile", "-o", "out/")
    assert result.exit_code == 1 and "notes.txt" in result.stderr
    assert snapshot(folder) == before


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="files have no size limit there")
@pytest.mark.parametrize("out", ["out.zip", "out/"])
def test_a_disk_that_is_full(folder: Path, out: str) -> None:
    import resource

    assert run("build", "cell.yaml", "--no-compile", "-o", out).exit_code == 0
    before = snapshot(folder)

    def small() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    (folder / "cell.yaml").write_text(RECIPE.replace("cell", "other"))
    before["cell.yaml"] = RECIPE.replace("cell", "other").encode()
    result = process("build", "cell.yaml", "--no-compile", "-o", out, preexec_fn=small)
    assert result.returncode == 1
    assert b"error[output-unwritable]: cannot write" in result.stderr
    assert snapshot(folder) == before


def test_an_interruption_while_writing(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run("build", "cell.yaml", "--no-compile", "--no-cache", "-o", "out.zip").exit_code == 0
    before = snapshot(folder)

    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(write, "_copy", interrupt)
    result = run("build", "cell.yaml", "--no-compile", "--no-cache", "-o", "out.zip")
    assert result.exit_code == 130
    assert "interrupted" in result.stderr
    assert snapshot(folder) == before


# -- the same bytes ------------------------------------------------------------------------------------------


def test_same_bytes_everywhere(folder: Path, tmp_path: Path) -> None:
    """Another folder, time zone, umask, hash seed and locale give the same archive."""
    import shutil

    from cli.shell import environment

    other = tmp_path / "another" / "place"
    shutil.copytree(folder, other)
    os.utime(other / "models" / "arm.xml", (1, 1))
    # Python 3.11 reads the path of an editable install as text of the locale, and ends where it cannot.
    ours = "C" if sys.prefix.isascii() else "C.UTF-8"
    kwargs = {} if sys.platform == "win32" else {"preexec_fn": lambda: os.umask(0o077)}
    here = process(
        "build",
        "--no-cache",
        "cell.yaml",
        "-o",
        "out.zip",
        cwd=folder,
        env=environment(PYTHONHASHSEED="1", TZ="UTC", LC_ALL=ours),
    )
    there = process(
        "build",
        "--no-cache",
        str(other / "cell.yaml"),
        "-o",
        str(other / "out.zip"),
        cwd=tmp_path,
        env=environment(PYTHONHASHSEED="2", TZ="Asia/Tokyo", LC_ALL="C.UTF-8"),
        **kwargs,
    )
    assert (here.returncode, there.returncode) == (0, 0), here.stderr + there.stderr
    assert (folder / "out.zip").read_bytes() == (other / "out.zip").read_bytes()


def test_source_date_epoch(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    assert run("build", "cell.yaml", "--no-compile", "-o", "out.zip").exit_code == 0
    with zipfile.ZipFile(folder / "out.zip") as bundle:
        assert {info.date_time[:3] for info in bundle.infolist()} == {(2023, 11, 14)}


# -- interruptions -------------------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc to see the child process")
@pytest.mark.parametrize(("sent", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_an_interruption_while_mujoco_works(folder: Path, tmp_path: Path, sent: signal.Signals, code: int) -> None:
    import subprocess
    import time

    from cli.shell import environment

    (folder / "slow.yaml").write_text(
        "recipe: 1\nadd:\n  - to: world\n    replicate:\n      count: 3000\n      offset: [1, 0, 0]\n"
        "      replicate: {count: 20, offset: [0, 1, 0], body: {geom: {size: [0.1]}}}\n"
    )
    before = snapshot(folder)
    temporary = tmp_path / "temporary"
    temporary.mkdir()
    started = subprocess.Popen(
        [
            sys.executable,
            "-m",
            "mjcompose",
            "build",
            "slow.yaml",
            "-o",
            "out.zip",
            "--limit",
            "expansion=1000000",
            "--limit",
            "bodies=100000",
        ],
        env=environment(TMPDIR=str(temporary)),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        # tests that were started in the background of a shell ignore it, and so would what they start
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    children = Path(f"/proc/{started.pid}/task/{started.pid}/children")
    deadline = time.monotonic() + 60
    while not (child := children.read_text().split()) and time.monotonic() < deadline:
        time.sleep(0.002)
    os.killpg(started.pid, sent) if sent is signal.SIGINT else started.send_signal(sent)
    out, error = started.communicate(timeout=60)
    assert child, "MuJoCo's process was seen"
    assert started.returncode == code, error
    assert out == b"" and b"Traceback" not in error
    while not _ended(child[0]) and time.monotonic() < deadline:
        time.sleep(0.01)  # one that was just being started ends when nobody talks to it
    assert _ended(child[0])
    assert snapshot(folder) == before
    assert list(temporary.iterdir()) == []


def _ended(process: str) -> bool:
    """Whether a process is gone, or waits only for somebody to take note of its end."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except (FileNotFoundError, ProcessLookupError):
        return True


# -- equal assets ---------------------------------------------------------------------------------------------


def test_equal_assets_of_several_parts_become_one(folder: Path) -> None:
    (folder / "two.yaml").write_text(
        "recipe: 1\nattach:\n  left: {model: ./models/arm.xml}\n  both: {model: ./nested.yaml, pos: [1, 0, 0]}\n"
    )
    (folder / "nested.yaml").write_text("recipe: 1\nattach:\n  right: {model: ./models/arm.xml}\n")
    merged = {"mesh": {"both/right/cover": "left/cover"}}
    result = run("build", "two.yaml", "--dedup", "-o", "out/")
    assert result.exit_code == 0, result.stderr
    assert "merged 1 mesh into" in result.stdout
    assert json.loads((folder / "out" / "manifest.json").read_text())["merged"] == merged
    assert mujoco.MjModel.from_xml_path(str(folder / "out" / "model.xml")).nmesh == 1
    told = run("build", "two.yaml", "--dedup", "--output-format", "json", "-o", "two.mjb")
    assert json.loads(told.stdout)["merged"] == merged
    alone = run("build", "two.yaml", "--dedup", "--no-compile", "-o", "-")
    assert alone.stdout.count("<mesh ") == 1 and "merged 1 mesh" in alone.stderr


def test_nothing_is_merged_unasked(folder: Path) -> None:
    (folder / "two.yaml").write_text(
        "recipe: 1\nattach:\n  left: {model: ./models/arm.xml}\n  right: {model: ./models/arm.xml}\n"
    )
    told = run("build", "two.yaml", "--output-format", "json", "--no-compile", "-o", "out/")
    assert "merged" not in json.loads(told.stdout)
    assert json.loads((folder / "out" / "manifest.json").read_text())["merged"] == {}
    assert (folder / "out" / "model.xml").read_text().count("<mesh ") == 2
    alone = run("build", "cell.yaml", "--dedup", "--output-format", "json", "--no-compile", "-o", "out/")
    assert "merged" not in json.loads(alone.stdout)


def test_a_model_of_other_values_is_replaced_and_that_is_said(folder: Path) -> None:
    recipe = folder / "cell.yaml"
    recipe.write_text(recipe.read_text() + "params: {mass: 1}\nedit: [{select: {geom: rod}, set: {mass: '${mass}'}}]\n")
    line = "  replaced the model with mass = 1\n"
    first, again = (run("build", "cell.yaml", "--no-compile") for _ in range(2))
    assert "replaced" not in first.stdout + again.stdout
    assert line in run("build", "cell.yaml", "--no-compile", "--set", "mass=2").stdout
    told = json.loads(run("build", "cell.yaml", "--no-compile", "--output-format", "json").stdout)
    assert told["replaced"] == {"mass": 2}
    for out in ("a/", "a.mjb"):
        assert "replaced" not in run("build", "cell.yaml", "--no-compile", "-o", out).stdout
        assert line in run("build", "cell.yaml", "--no-compile", "-o", out, "--set", "mass=2").stdout
    (folder / "other.yaml").write_text(recipe.read_text())
    assert "  replaced the model of cell.yaml\n" in run("build", "other.yaml", "--no-compile").stdout
    # What changes in the recipe itself is what one builds again for.
    recipe.write_text(recipe.read_text().replace("rod", "palm").replace("geom: palm", "geom: tool/palm"))
    run("build", "cell.yaml", "--no-compile")
    recipe.write_text(recipe.read_text().replace("name: cell", "name: cell\ndescription: new"))
    assert "replaced" not in run("build", "cell.yaml", "--no-compile").stdout
