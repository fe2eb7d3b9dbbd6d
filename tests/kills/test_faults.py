"""Faults of the machine: a build says in one line what is the matter, leaves what was there, and succeeds when it is mended."""

from __future__ import annotations

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from kills.project import OUTPUTS, Output, Project, digest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform == "win32", reason="limits and mounts are those of POSIX"),
]
ARCHIVE = OUTPUTS[0]


@pytest.fixture
def project(tmp_path: Path) -> Project:
    made = Project(tmp_path / "project")
    made.make()
    return made


def _ends_well(project: Project, output: Output) -> None:
    """The same build on a machine without the fault."""
    code, said = project.run(output.words)
    assert code == 0, said


def _fails_in_one_line(code: int, said: str) -> None:
    assert code == 1 and "Traceback" not in said and "bug in mjcompose" not in said, said
    assert "error[" in said or said.startswith("cannot continue: "), said


@pytest.mark.parametrize(
    ("output", "room"),
    [*((each, 1000) for each in OUTPUTS), (ARCHIVE, 0), (ARCHIVE, 4000)],
    ids=lambda each: each.name if isinstance(each, Output) else str(each),
)
def test_files_that_cannot_grow(project: Project, output: Output, room: int) -> None:
    """As where the disk is full: every file ends after so many bytes."""
    import resource

    _ends_well(project, output)
    before = project.written(output)
    project.edit("2")
    shutil.rmtree(project.folder / "store")

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))

    process = project.start(output.words, preexec_fn=limit)
    said, _ = process.communicate(timeout=120)
    if process.returncode:
        _fails_in_one_line(process.returncode, said.decode())
        kept = {path: found for path, found in project.written(output).items() if path in before}
        assert kept.keys() == before.keys()
    _ends_well(project, output)


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Callable[[str], Path]]:
    """Mounts a disk of 64 KiB; `options` are those of the mount. Skips where that is not allowed."""
    mounted: list[Path] = []

    def mount(options: str = "") -> Path:
        folder = tmp_path / f"disk{len(mounted)}"
        folder.mkdir()
        words = ["mount", "-t", "tmpfs", "-o", f"size=64k{options}", "none", str(folder)]
        if not shutil.which("mount") or subprocess.run(words, capture_output=True, check=False).returncode:
            pytest.skip("a file system can only be mounted by root, outside of most containers")
        mounted.append(folder)
        return folder

    yield mount
    for folder in mounted:
        subprocess.run(["umount", str(folder)], check=True)


def test_a_disk_that_is_full(project: Project, small_disk: Callable[[str], Path]) -> None:
    disk = small_disk("")
    (disk / "a.zip").write_bytes(b"old")
    (disk / "rest").write_bytes(bytes(60_000))
    code, said = project.run((*ARCHIVE.words[:-1], str(disk / "a.zip")))
    _fails_in_one_line(code, said)
    assert sorted(each.name for each in disk.iterdir()) == ["a.zip", "rest"]
    assert (disk / "a.zip").read_bytes() == b"old"


@pytest.mark.parametrize("words", [("--jobs", "1"), ("--jobs", "3")])
def test_many_models_end_with_the_first_that_finds_no_room(
    project: Project, small_disk: Callable[[str], Path], words: tuple[str, ...]
) -> None:
    """One error, whole models, and how to go on."""
    folder = _alone(project)
    (folder / "many.yaml").write_text(
        "recipe: 1\nbase: ./arm.xml\nrandomize:\n  seed: 1\n  samples: 60\n"
        "  fields: {mass: {select: {body: '*'}, attr: mass, scale: {uniform: [0.9, 1.1]}}}\n"
    )
    disk = small_disk("")
    code, said = project.run(("build", str(folder / "many.yaml"), "--all", *words, "-o", str(disk / "{name}.zip")))
    assert code == 1 and said.count("error[output-full]") == 1 and "are written and whole" in said, said
    models = list(disk.glob("*.zip"))
    assert models and all(zipfile.is_zipfile(each) for each in models)
    assert not list(disk.glob(".*"))


def test_a_place_that_is_read_only(project: Project, small_disk: Callable[[str], Path]) -> None:
    disk = small_disk(",ro")
    code, said = project.run((*ARCHIVE.words[:-1], str(disk / "a.zip")))
    _fails_in_one_line(code, said)
    store = {"MJCOMPOSE_CACHE": str(disk / "store")}
    process = subprocess.run(
        [sys.executable, "-m", "mjcompose", *ARCHIVE.words],
        cwd=project.folder / "cell",
        env={**project.environment, **store},
        capture_output=True,
        check=False,
        timeout=120,
    )
    _fails_in_one_line(process.returncode, process.stderr.decode())


def test_without_a_home(project: Project) -> None:
    names = ("HOME", "MJCOMPOSE_CACHE", "XDG_CACHE_HOME", "USERPROFILE")
    bare = {name: value for name, value in project.environment.items() if name not in names}
    for home in ({}, {"HOME": "/nonexistent/home"}, {"HOME": ""}):
        process = subprocess.run(
            [sys.executable, "-m", "mjcompose", "build", "arm.xml.yaml", "-o", "out/a.zip"],
            cwd=_alone(project),
            env={**bare, **home},
            capture_output=True,
            check=False,
            timeout=120,
        )
        assert process.returncode == 0, process.stderr.decode()


def _alone(project: Project) -> Path:
    """A recipe that fetches nothing."""
    folder = project.folder / "cell"
    (folder / "arm.xml.yaml").write_text("recipe: 1\nbase: ./arm.xml\n")
    return folder


def test_without_shared_memory(project: Project) -> None:
    command = f"mount -t tmpfs -o size=0,mode=000,nr_inodes=1 none /dev/shm && exec {sys.executable} -m mjcompose build arm.xml.yaml -o out/a.zip"
    if (
        not shutil.which("unshare")
        or subprocess.run(["unshare", "-m", "true"], capture_output=True, check=False).returncode
    ):
        pytest.skip("a mount of its own can only be had by root, outside of most containers")
    process = subprocess.run(
        ["unshare", "-m", "sh", "-c", command],
        cwd=_alone(project),
        env=project.environment,
        capture_output=True,
        check=False,
        timeout=120,
    )
    if b"mount:" in process.stderr:
        pytest.skip("/dev/shm cannot be replaced here")
    assert process.returncode == 0, process.stderr.decode()


def test_with_a_temporary_folder_that_is_gone(project: Project) -> None:
    (project.folder / "tmp").rmdir()
    code, said = project.run(ARCHIVE.words)
    assert code in (0, 1) and "Traceback" not in said and "bug in mjcompose" not in said, said


def test_many_builds_at_once_with_prunes_in_between(project: Project) -> None:
    words = [(*ARCHIVE.words[:-1], f"out/{number}.zip") for number in range(12)]
    running = [project.start(each) for each in words]
    for _ in range(3):
        code, said = project.run(("cache", "prune"))
        assert code == 0, said
    for process in running:
        said, _ = process.communicate(timeout=280)
        assert process.returncode == 0, said.decode()
    written = {digest(project.folder / "cell" / f"out/{number}.zip") for number in range(12)}
    names = {len((project.folder / "cell" / f"out/{number}.zip").read_bytes()) for number in range(12)}
    assert len(names) == 1 and len(written) == 12  # the digest has the name in it
