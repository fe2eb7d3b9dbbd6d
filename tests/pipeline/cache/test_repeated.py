"""The same command once more, as a process: from the cache, and never when anything is not as it was."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from cli.shell import RECIPE, environment
from mjcompose.sources.store import store_folder
from sampling import rest_slow

# Files are told by their stamps two seconds after they were written; nobody here waits for that.
_PROGRAM = """
import sys
import mjcompose.pipeline.cache.cache_key
mjcompose.pipeline.cache.cache_key._SETTLED = {wait}
sys.argv = ["mjcompose", *{arguments!r}]
from mjcompose.cli.entry import main
try:
    main()
finally:
    heavy = [name for name in ("numpy", "pydantic", "lxml", "yaml", "mujoco") if name in sys.modules]
    print("built" if heavy else "known", file=sys.stderr)
"""
_WARNED = """\
recipe: 1
name: warned
conflict: base
base: ./models/arm.xml
option: {gravity: [0, 0, -9]}
attach:
  other: {model: ./other.xml}
check: {heavy: {expect: {attr: mass, range: [0.1, 100000]}}}
"""
BUILD = ("build", "cell.yaml", "-o", "out.zip", "--no-compile")


def command(*arguments: str, wait: int = 0, **more: str) -> tuple[str, int, str, str]:
    """Whether the model was `built` or `known`, the exit code, standard output and standard error.

    What is known needs no library that reads recipes or models, let alone MuJoCo.
    """
    program = _PROGRAM.format(arguments=arguments, wait=wait)
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment(**more), capture_output=True, text=True, timeout=120
    )
    *said, how = done.stderr.splitlines(keepends=True)
    return how.strip(), done.returncode, done.stdout, "".join(said)


@pytest.fixture
def recipes(store: Path, folder: Path) -> Path:
    """The folder of the recipes, and of a store."""
    (folder / "other.xml").write_text('<mujoco><option timestep="0.001"/><worldbody/></mujoco>')
    (folder / "warned.yaml").write_text(_WARNED)
    (folder / "values.yaml").write_text("{}\n")
    (folder / "build").mkdir()
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ("build", "cell.yaml", "-o", "build/{name}.mjz", "--licenses", "--why"),
        ("build", "warned.yaml", "-o", "build/x/"),
        ("build", "warned.yaml", "-o", "build/x.xml", "--output-format", "json"),
        ("build", "warned.yaml", "-o", "build/x.mjb"),
        ("build", "warned.yaml", "-o", "build/x.zip", "--output-format", "github", "--set-file", "values.yaml"),
        ("check", "warned.yaml"),
        ("check", "warned.yaml", "cell.yaml", "--output-format", "json"),
    ],
)
def test_what_is_known_is_reported_as_when_it_was_built(recipes: Path, arguments: tuple[str, ...]) -> None:
    command(*arguments)
    again = command(*arguments)
    assert again[:2] == ("known", 0)
    anew = command(*arguments, "--no-cache")
    assert anew[0] == "built"
    if arguments[0] == "check":
        assert anew[1:] == again[1:]


@pytest.mark.parametrize("out", rest_slow(["build/a.zip", "build/deeper/a.xml"], ["build/a.zip"]))
def test_what_is_gone_or_another_is_written_from_the_store(recipes: Path, out: str) -> None:
    build = ("build", "cell.yaml", "-o", out, "--no-compile")
    first = command(*build)
    whole = (recipes / out).read_bytes()
    for spoil in (Path.unlink, lambda path: path.write_text("another")):
        spoil(recipes / out)
        assert command(*build) == ("known", *first[1:])
        assert (recipes / out).read_bytes() == whole
    assert "is up to date" in command(*build)[2]
    assert os.listdir((recipes / out).parent) == [(recipes / out).name]


def _extend(path: str, text: str) -> Callable[[Path], object]:
    return lambda folder: (folder / path).write_text((folder / path).read_text() + text)


def _touch(folder: Path) -> None:
    os.utime(folder / "cell.yaml", (0, 0))


@pytest.mark.slow
@pytest.mark.parametrize(
    "change",
    [
        _extend("cell.yaml", "option: {timestep: 0.001}\n"),
        _extend("models/arm.xml", "<!-- more -->\n"),
        _extend("models/meshes/cover.obj", "v 0 0 5\n"),
        lambda folder: (folder / "models" / "NOTICE").write_text("a notice"),
        lambda folder: (folder / "cell.lock").write_text("no lock"),
        lambda folder: (folder / "models" / "tool.xml").unlink(),
        _touch,
    ],
    ids=["recipe", "model", "mesh", "license", "lock", "gone", "touched"],
)
def test_whatever_changes_is_seen(recipes: Path, change: Callable[[Path], object]) -> None:
    command(*BUILD)
    assert command(*BUILD)[0] == "known"
    change(recipes)
    changed = command(*BUILD)
    assert changed[0] == ("known" if change is _touch else "built")
    (recipes / "out.zip").rename(recipes / "first.zip")
    plain = command(*BUILD, "--no-cache")
    assert changed[1] == plain[1] and changed[3] == plain[3]
    if plain[1] == 0:
        assert (recipes / "out.zip").read_bytes() == (recipes / "first.zip").read_bytes()


def test_a_change_that_keeps_size_and_time_is_seen(recipes: Path) -> None:
    recipe = recipes / "cell.yaml"
    command(*BUILD)
    before = recipe.stat()
    recipe.write_text(RECIPE.replace("name: cell", "name: bell"))
    os.utime(recipe, ns=(before.st_atime_ns, before.st_mtime_ns))
    assert recipe.stat().st_size == before.st_size
    assert command(*BUILD)[0] == "built"
    with zipfile.ZipFile(recipes / "out.zip") as bundle:
        assert b'model="bell"' in bundle.read("model.xml")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("more", "how"),
    [
        ({"SOURCE_DATE_EPOCH": "1700000000"}, "known"),
        ({"MENAGERIE_ROOT": "/nowhere"}, "built"),
        ({"MJCOMPOSE_CACHE_SIZE": "1G"}, "known"),
        ({"PYTHONIOENCODING": "ascii"}, "known"),
    ],
)
def test_what_runs_otherwise_is_built_where_that_may_matter(recipes: Path, more: dict[str, str], how: str) -> None:
    command(*BUILD)
    assert command(*BUILD, **more)[0] == how
    assert command(*BUILD)[0] == "known"


def test_the_same_recipe_in_other_words_is_known(recipes: Path) -> None:
    command(*BUILD)
    assert command("build", "./cell.yaml", *BUILD[2:])[0] == "known"


@pytest.mark.slow
def test_values_of_a_file_count(recipes: Path) -> None:
    (recipes / "cell.yaml").write_text(RECIPE + "params: {x: 1}\noption: {gravity: [0, 0, '${x}']}\n")
    build = (*BUILD, "--set-file", "values.yaml")
    command(*build)
    (recipes / "values.yaml").write_text("x: 2\n")
    how, code, out, _ = command(*build)
    assert (how, code) == ("built", 0) and out.startswith("wrote")


def test_a_file_that_was_just_written_is_known_by_its_content(recipes: Path) -> None:
    command(*BUILD, wait=10**15)
    assert command(*BUILD, wait=10**15)[0] == "known"


@pytest.mark.slow
def test_a_link_to_a_source_in_the_place_of_the_output(recipes: Path) -> None:
    command(*BUILD)
    (recipes / "out.zip").unlink()
    try:
        (recipes / "out.zip").symlink_to("cell.yaml")
    except OSError:
        pytest.skip("no links here")
    how, code, _, err = command(*BUILD)
    assert (how, code) == ("known", 1)
    assert "is one of the files that this model is built from" in err
    assert (recipes / "cell.yaml").read_text() == RECIPE


@pytest.mark.slow
def test_an_output_that_cannot_be_written_is_an_error_as_ever(recipes: Path) -> None:
    build = ("build", "cell.yaml", "-o", "build/out.zip", "--no-compile")
    command(*build)
    (recipes / "build" / "out.zip").unlink()
    (recipes / "build").rmdir()
    (recipes / "build").write_text("in the way")
    how, code, _, err = command(*build)
    assert (how, code) == ("known", 1)
    assert "error[output-unwritable]" in err


@pytest.mark.slow
@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is full")
def test_a_stream_that_is_full_is_told(recipes: Path) -> None:
    command(*BUILD)
    entry = [sys.executable, "-m", "mjcompose", *BUILD]
    with open("/dev/full", "w") as full:
        done = subprocess.run(entry, env=environment(), stdout=full, stderr=subprocess.PIPE, text=True)
    assert (done.returncode, done.stderr) == (1, "cannot continue: no space left on device\n")


def test_the_folder_of_the_store_is_the_systems(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from platformdirs import user_cache_dir

    for caches in ("", " ", str(tmp_path)):
        monkeypatch.setenv("XDG_CACHE_HOME", caches)
        assert store_folder({"XDG_CACHE_HOME": caches}) == user_cache_dir("mjcompose", appauthor=False)


@pytest.mark.slow
def test_what_is_known_keeps_what_it_was_fetched_with(recipes: Path, store: Path) -> None:
    git = ["git", "-c", "user.name=a", "-c", "user.email=a@example.org"]
    for words in (["init", "-q"], ["add", "models"], ["commit", "-q", "-m", "first"]):
        subprocess.run([*git, *words], cwd=recipes, check=True)
    head = subprocess.run([*git, "rev-parse", "HEAD"], cwd=recipes, check=True, capture_output=True, text=True)
    (recipes / "cell.yaml").write_text(f"recipe: 1\nbase: git+file://{recipes}@{head.stdout.strip()}#models/arm.xml\n")
    command(*BUILD)
    (entry,) = store.glob("git/*/entry.json")
    for wait in (10**15, 0, 0):
        os.utime(entry, (0, 0))
        how = command(*BUILD, wait=wait)[0]
        assert entry.stat().st_mtime > 0
    assert how == "known"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="names are text here")
def test_names_that_are_no_text(recipes: Path) -> None:
    (recipes / "cell.yaml").rename(os.fsdecode(os.fsencode(recipes) + b"/caf\xe9.yaml"))
    words = [sys.executable, "-m", "mjcompose", "build", b"caf\xe9.yaml", "--no-compile", "-o", b"caf\xe9.zip"]
    program = _PROGRAM.format(arguments=("build", "caf\udce9.yaml", "--no-compile", "-o", "caf\udce9.zip"), wait=0)
    first, again = (
        subprocess.run([sys.executable, "-c", program], env=environment(), capture_output=True) for _ in range(2)
    )
    assert again.stderr.endswith(b"known\n") and again.returncode == 0
    assert again.stdout.startswith(b"caf\xe9.zip is up to date\n")
    assert first.stdout.startswith(b"wrote caf\xe9.zip\n")
    assert subprocess.run(words, env=environment(), capture_output=True).returncode == 0


@pytest.mark.slow
def test_a_model_of_other_values_is_replaced_and_reported(recipes: Path) -> None:
    (recipes / "cell.yaml").write_text(RECIPE + "params: {x: 1}\noption: {gravity: [0, 0, '${x}']}\n")
    one, two = (("build", "cell.yaml", "--no-compile", "--set", f"x={x}") for x in (1, 2))
    for _ in range(2):
        command(*one)
        command(*two)
    assert command(*two)[0] == "known"
    how, code, told, _ = command(*one)
    assert (how, code) == ("known", 0) and "  replaced the model with x = 2\n" in told
    how, code, told, _ = command(*one)
    assert how == "known" and "replaced" not in told and "is up to date" in told
