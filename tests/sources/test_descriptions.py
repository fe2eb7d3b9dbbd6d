from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from mjcompose.sources.fetching import Fetching
from mjcompose.sources.lock import resolve
from mjcompose.sources.reference import SourceError


@pytest.fixture
def library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A stand-in for robot_descriptions: what it clones is at hand, and it prints as the real one does."""
    repository = tmp_path / "clones" / "menagerie"
    package = tmp_path / "site" / "robot_descriptions"
    for folder in (repository / "arm", package):
        folder.mkdir(parents=True)
    (repository / "LICENSE").write_text("Apache")
    (repository / "arm" / "arm.xml").write_text("<mujoco/>")
    (repository / "arm" / "arm.urdf").write_text("<robot/>")
    paths = f"print('Cloning ...')\nREPOSITORY_PATH = {str(repository)!r}\n"
    modules = {
        "__init__": "",
        "arm_mj_description": f"{paths}MJCF_PATH = REPOSITORY_PATH + '/arm/arm.xml'\n",
        "arm_description": f"{paths}URDF_PATH = REPOSITORY_PATH + '/arm/arm.urdf'\n",
        "gone_mj_description": f"{paths}MJCF_PATH = REPOSITORY_PATH + '/arm/gone.xml'\n",
        "macro_description": f"{paths}XACRO_PATH = REPOSITORY_PATH + '/arm/arm.xacro'\n",
        "offline_mj_description": "raise OSError('no route to host')\n",
        "cloned_mj_description": f"import subprocess\nsubprocess.run(['git', 'ls-remote', {str(tmp_path)!r}], check=True)\n"
        f"{paths}MJCF_PATH = REPOSITORY_PATH + '/arm/arm.xml'\n",
        "_empty_description": "",
    }
    for name, text in modules.items():
        (package / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path / "site"))
    _forget()
    yield repository
    _forget()


def _forget() -> None:
    for name in [each for each in sys.modules if each.partition(".")[0] == "robot_descriptions"]:
        del sys.modules[name]


def fail(text: str) -> SourceError:
    with pytest.raises(SourceError) as caught:
        resolve(text, relative_to=Path(), environment={})
    return caught.value


@pytest.mark.parametrize(
    ("text", "file", "kind"),
    [("descriptions:arm_mj_description", "arm.xml", "mjcf"), ("descriptions:arm_description", "arm.urdf", "urdf")],
)
def test_finds_a_description(
    library: Path, capsys: pytest.CaptureFixture[str], text: str, file: str, kind: str
) -> None:
    source = resolve(text, relative_to=Path(), environment={})
    assert source.path == library / "arm" / file
    assert (source.kind.name, source.package, source.format) == ("descriptions", "robot_descriptions", kind)
    assert source.licenses == ((library / "LICENSE").resolve(),)
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize(("head", "expected"), [("a" * 40, "a" * 40), ("ref: refs/heads/main", None)])
def test_the_commit_is_the_one_that_is_checked_out(library: Path, head: str, expected: str | None) -> None:
    origin = resolve("descriptions:arm_mj_description", relative_to=Path(), environment={}).origin
    assert origin is not None and origin.commit is None
    (library / ".git").mkdir()
    (library / ".git" / "HEAD").write_text(f"{head}\n")
    origin = resolve("descriptions:arm_mj_description", relative_to=Path(), environment={}).origin
    assert origin is not None and origin.commit == expected


@pytest.mark.parametrize(
    ("text", "code", "message", "fix"),
    [
        ("descriptions:arm", "source-not-found", "no description `arm`", "write `descriptions:arm_mj_description`"),
        (
            "descriptions:arm_mj_descripton",
            "source-not-found",
            "no description",
            "write `descriptions:arm_mj_description`",
        ),
        ("descriptions:_empty_description", "source-not-found", "no description", None),
        ("descriptions:offline_mj_description", "source-not-found", "could not be fetched", None),
        ("descriptions:gone_mj_description", "source-not-found", "which is not a model file", None),
        ("descriptions:macro_description", "source-kind", "neither MJCF nor URDF", None),
    ],
)
@pytest.mark.usefixtures("library")
def test_what_is_not_there(text: str, code: str, message: str, fix: str | None) -> None:
    error = fail(text)
    assert error.code == code
    assert message in error.message
    assert error.help == fix


@pytest.mark.usefixtures("library")
def test_says_why_a_fetch_failed() -> None:
    assert fail("descriptions:offline_mj_description").notes == ("no route to host",)


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mjcompose.sources.packages.folders", lambda _: [])
    error = fail("descriptions:arm_mj_description")
    assert error.code == "source-not-found"
    assert error.help == "run `pip install robot_descriptions`"


def test_nothing_is_cloned_offline(library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("GIT_ALLOW_PROTOCOL", raising=False)
    subprocess.run(["git", "init", "-q", "--bare", str(tmp_path)], check=True)
    with pytest.raises(SourceError, match="nothing is fetched offline") as caught:
        find("descriptions:cloned_mj_description", offline=True)
    assert caught.value.code == "source-offline"
    assert find("descriptions:cloned_mj_description").is_file()
    assert find("descriptions:arm_mj_description", offline=True).is_file()


def test_git_does_not_obey_the_repository_around_the_current_folder(
    library: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The package clones with git, and the folder of a recipe may be a repository of anybody."""
    theirs = tmp_path / "theirs"
    subprocess.run(["git", "init", "-q", str(theirs)], check=True)
    (theirs / "git").write_text(f"#!/bin/sh\ntouch {tmp_path}/ran\n")
    (theirs / "git").chmod(0o755)
    (theirs / "subprocess.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    with (theirs / ".git" / "config").open("a") as config:
        config.write(f'[url "{theirs}/.git"]\n    insteadOf = {tmp_path}\n[alias]\n    x = "!touch {tmp_path}/ran"\n')
    package = tmp_path / "site" / "robot_descriptions"
    asks = (
        "import subprocess\nif subprocess.run(['git', 'x'], stderr=subprocess.DEVNULL).returncode == 0: raise OSError\n"
    )
    text = (package / "arm_mj_description.py").read_text()
    (package / "arm_mj_description.py").write_text(asks + text)
    monkeypatch.chdir(theirs)
    monkeypatch.setenv("PATH", f".:{os.environ['PATH']}")
    assert find("descriptions:arm_mj_description").is_file()
    assert not (tmp_path / "ran").exists()


def find(text: str, offline: bool = False) -> Path:
    return resolve(text, relative_to=Path(), environment={}, fetching=Fetching(offline=offline)).path
