"""MuJoCos of other versions: where they are, who may have put them there, and how an installer is started."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from mjcompose.mujoco import programs
from mjcompose.mujoco.programs import ProgramError

posix = pytest.mark.skipif(os.name != "posix", reason="the modes of files are those of POSIX")
VERSION = "3.13.0"
PRETENDS = """#!/bin/sh
# What `uv venv FOLDER` and `uv pip install --python PYTHON` make, and what they see.
for last; do :; done
{ pwd; ls -A; env; echo "$@"; } >> "$XDG_CACHE_HOME/seen"
case " $* " in
*" venv "*) mkdir -p "$last/bin"; ln -s /bin/sh "$last/bin/python";;
esac
"""


@pytest.fixture
def environment(tmp_path: Path) -> dict[str, str]:
    """An environment with a folder of programs of its own, and with a `uv` that only writes down how it is started."""
    (tmp_path / "tools").mkdir()
    (tmp_path / "tools" / "uv").write_text(PRETENDS)
    (tmp_path / "tools" / "uv").chmod(0o755)
    path = f"{tmp_path / 'tools'}{os.pathsep}/usr/bin{os.pathsep}/bin"
    return {"PATH": path, "MJCOMPOSE_PROGRAMS": str(tmp_path / "programs"), "XDG_CACHE_HOME": str(tmp_path)}


def install(environment: dict[str, str]) -> bool:
    return programs.install(VERSION, environment, lambda words: None)


@posix
def test_a_version_is_installed_once_and_removed(tmp_path: Path, environment: dict[str, str]) -> None:
    with pytest.raises(ProgramError, match="not installed") as missing:
        programs.python_in(VERSION, environment)
    assert missing.value.help == "run `mjcompose install mujoco==3.13.0`"
    assert programs.installed(environment) == {}
    assert install(environment) and not install(environment)
    python = tmp_path / "programs" / "mujoco-3.13.0" / "bin" / "python"
    assert programs.installed(environment) == {VERSION: python}
    assert programs.python_in(VERSION, environment) == python
    assert (tmp_path / "programs").stat().st_mode & 0o777 == 0o700
    assert programs.uninstall(VERSION, environment) and not programs.uninstall(VERSION, environment)
    assert not python.exists()


@posix
def test_an_installer_sees_nothing_of_the_current_folder(
    tmp_path: Path, environment: dict[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    theirs = tmp_path / "theirs"
    theirs.mkdir()
    (theirs / "uv.toml").touch()
    monkeypatch.chdir(theirs)
    own = {"UV_INDEX_URL": "https://example.org", "https_proxy": "http://proxy", "HOME": str(tmp_path)}
    foreign = {
        "PIP_TARGET": ".",
        "UV_PROJECT": ".",
        "PYTHONPATH": ".",
        "VIRTUAL_ENV": ".venv",
        "UV_CONFIG_FILE": "uv.toml",
    }
    install({**environment, **own, **foreign, "PATH": f":.:{environment['PATH']}"})
    seen = (tmp_path / "seen").read_text()
    assert "--no-config venv" in seen and "--no-config pip install" in seen
    assert "uv.toml\n" not in seen.replace("UV_CONFIG_FILE=uv.toml\n", "") and str(theirs) not in seen
    assert all(f"{name}={value}\n" in seen for name, value in own.items())
    assert not any(f"\n{name}=" in seen for name in foreign if name != "UV_CONFIG_FILE")
    assert f"\nPATH={environment['PATH']}\n" in seen


@posix
def test_the_settings_of_the_user_stay(tmp_path: Path, environment: dict[str, str]) -> None:
    settings = tmp_path / "config" / "uv" / "uv.toml"
    settings.parent.mkdir(parents=True)
    settings.touch()
    install({**environment, "XDG_CONFIG_HOME": str(tmp_path / "config")})
    seen = (tmp_path / "seen").read_text()
    assert f"--config-file {settings} venv" in seen and "--no-config" not in seen
    (tmp_path / "seen").unlink()
    programs.uninstall(VERSION, environment)
    install({**environment, "UV_CONFIG_FILE": str(settings)})
    seen = (tmp_path / "seen").read_text()
    assert f"UV_CONFIG_FILE={settings}\n" in seen and "--no-config" not in seen


def test_without_uv_python_and_pip_are_isolated(tmp_path: Path) -> None:
    make, install = programs._commands(tmp_path / "there", VERSION, {"PATH": str(tmp_path)})
    assert make[:4] == [sys.executable, "-I", "-m", "venv"]
    assert install[1:5] == ["-I", "-m", "pip", "install"]
    assert "--only-binary :all:" in " ".join(install)  # a package that is built runs its own code


@posix
def test_what_fails_leaves_nothing(tmp_path: Path, environment: dict[str, str]) -> None:
    (tmp_path / "tools" / "uv").write_text("#!/bin/sh\nmkdir -p $5 $6\necho 'error: no such wheel' >&2\nexit 2\n")
    with pytest.raises(ProgramError, match=r"MuJoCo 3\.13\.0 cannot be installed: error: no such wheel"):
        install(environment)
    assert [path.name for path in (tmp_path / "programs").iterdir()] == ["mujoco-3.13.0.lock"]


@posix
@pytest.mark.parametrize(
    ("path", "mode", "why"),
    [
        ("programs", 0o770, "others may use"),
        ("programs", 0o701, "others may use"),
        ("real", 0o777, "others may write to"),
        ("real/python", 0o757, "others may write to"),
    ],
)
def test_a_program_that_somebody_else_can_change_is_refused(
    tmp_path: Path, environment: dict[str, str], path: str, mode: int, why: str
) -> None:
    install(environment)
    (tmp_path / "real").mkdir()
    (tmp_path / "real" / "python").write_text("#!/bin/sh\n")
    python = programs.python_in(VERSION, environment)
    python.unlink()
    python.symlink_to(tmp_path / "real" / "python")
    assert programs.python_in(VERSION, environment) == python
    (tmp_path / path).chmod(mode)
    with pytest.raises(ProgramError, match=why) as refused:
        programs.python_in(VERSION, environment)
    assert refused.value.help is not None and "mjcompose install mujoco==3.13.0" in refused.value.help


@posix
@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root gives files to others")
@pytest.mark.parametrize("path", ["programs", "programs/mujoco-3.13.0", "programs/mujoco-3.13.0/bin/python"])
def test_a_program_of_another_user_is_refused(tmp_path: Path, environment: dict[str, str], path: str) -> None:
    install(environment)
    os.chown(tmp_path / path, 12345, -1, follow_symlinks=False)
    with pytest.raises(ProgramError, match="belongs to another user"):
        programs.python_in(VERSION, environment)
    if path == "programs":
        with pytest.raises(ProgramError, match="nothing is installed into .* belongs to another user"):
            programs.install("3.12.0", environment, lambda words: None)
    else:
        assert install(environment), "a program that is not trusted is installed again"
        assert programs.python_in(VERSION, environment).exists()


@posix
@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root gives files to others")
@pytest.mark.parametrize(
    ("owner", "group", "mode", "why"),
    [
        (12345, -1, 0o755, "belongs to another user"),
        (-1, 12345, 0o775, "others may write to"),
        (-1, 12345, 0o1775, "others may write to"),  # only in folders the bit protects files
        (-1, 12345, 0o755, None),
    ],
)
def test_the_program_behind_a_link_is_root_s_or_the_user_s(
    tmp_path: Path, environment: dict[str, str], owner: int, group: int, mode: int, why: str | None
) -> None:
    install(environment)
    python = tmp_path / "programs" / "mujoco-3.13.0" / "bin" / "python"
    python.unlink()
    python.symlink_to(tmp_path / "real")
    (tmp_path / "real").write_text("#!/bin/sh\n")
    (tmp_path / "real").chmod(mode)
    os.chown(tmp_path / "real", owner, group)
    if why is None:
        assert programs.python_in(VERSION, environment) == python
        return
    with pytest.raises(ProgramError, match=why):
        programs.python_in(VERSION, environment)


@posix
def test_a_folder_that_is_open_to_others_gets_no_program(tmp_path: Path, environment: dict[str, str]) -> None:
    (tmp_path / "programs").mkdir(mode=0o755)
    with pytest.raises(ProgramError, match="nothing is installed into"):
        install(environment)
    (tmp_path / "programs").rmdir()
    (tmp_path / "programs").symlink_to(tmp_path / "tools")
    with pytest.raises(ProgramError, match="is not a folder"):
        install(environment)


@pytest.mark.parametrize("named", ["programs", "./programs", "../programs"])
def test_the_folder_is_an_absolute_path(named: str) -> None:
    """A relative one would be in whatever folder you type the command."""
    with pytest.raises(ProgramError, match="not an absolute path"):
        programs.programs_folder({"MJCOMPOSE_PROGRAMS": named})


@pytest.mark.skipif(sys.platform != "linux", reason="other systems have other folders")
def test_the_folder_is_the_users_own(tmp_path: Path) -> None:
    home = Path(os.path.expanduser("~/.local/share/mjcompose/programs"))
    assert programs.programs_folder({}) == programs.programs_folder({"XDG_DATA_HOME": "relative"}) == home
    assert programs.programs_folder({"XDG_DATA_HOME": str(tmp_path)}) == tmp_path / "mjcompose" / "programs"
