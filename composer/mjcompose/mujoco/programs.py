"""MuJoCos of other versions, in a folder of the user's own. The user installs them, and no check does.

`programs/mujoco-VERSION/` is an environment of Python; it is complete if it has the file `.ready`. An environment
cannot be moved, so it is made in its place, under a lock. The store of fetched files, which several users may share,
has no programs: whoever can change a program here could run anything as the user.
"""

from __future__ import annotations

import os
import re
import shutil
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from mjcompose.base.processes import DEVNULL, PIPE, Overrun, Process, isolated, program
from mjcompose.sources.blobs import lock_file
from mjcompose.tree.history import release

PROGRAMS = "MJCOMPOSE_PROGRAMS"
"""The variable that names the folder of programs."""
MUJOCO = "mujoco"
_READY = ".ready"
_INSTALLING = 900.0
_LONGEST = 300


class ProgramError(Exception):
    """A program is not there, cannot be installed, or is not trusted."""

    def __init__(self, message: str, help: str | None = None) -> None:
        super().__init__(message)
        self.help = help


class MissingError(ProgramError):
    """These versions of MuJoCo are not installed."""

    def __init__(self, versions: Iterable[str]) -> None:
        missing = list(versions)
        several = len(missing) > 1
        super().__init__(
            f"MuJoCo {' and '.join(missing)} {'are' if several else 'is'} not installed",
            f"run `mjcompose install {' '.join(f'{MUJOCO}=={version}' for version in missing)}`",
        )


def programs_folder(environment: Mapping[str, str]) -> Path:
    """Return the folder of programs: `MJCOMPOSE_PROGRAMS`, or a folder of the user's data. Raises ProgramError."""
    named = environment.get(PROGRAMS, "")
    folder = Path(os.path.expanduser(named)) if named else _data_folder(environment) / "mjcompose" / "programs"
    if not folder.is_absolute():
        message = f"the folder of programs, `{folder}`, is not an absolute path"
        raise ProgramError(message, f"set `{PROGRAMS}` to an absolute path")
    return folder


def _data_folder(environment: Mapping[str, str]) -> Path:
    if sys.platform != "linux":
        from platformdirs import user_data_dir

        return Path(user_data_dir(appauthor=False))
    folder = environment.get("XDG_DATA_HOME", "")
    # The specification of XDG ignores a relative path.
    return Path(folder if os.path.isabs(folder) else os.path.expanduser("~/.local/share"))


def installed(environment: Mapping[str, str]) -> dict[str, Path]:
    """Return the Pythons of the versions that are installed, by version. Raises ProgramError."""
    folder = programs_folder(environment)
    try:
        names = sorted(os.listdir(folder))
    except OSError:
        return {}
    versions = [name.removeprefix(f"{MUJOCO}-") for name in names if os.path.isfile(folder / name / _READY)]
    return {version: python_of(_place(folder, version)) for version in versions if release(version) == version}


def python_in(version: str, environment: Mapping[str, str]) -> Path:
    """Return the Python of an installed version. Raises MissingError, and ProgramError if it is not trusted."""
    folder = programs_folder(environment)
    place = _place(folder, version)
    if not os.path.lexists(place / _READY):
        raise MissingError([version])
    python = python_of(place)
    why = untrusted_program(folder, python)
    if why is not None:
        message = f"MuJoCo {version} in `{place}` is not run: {why}"
        raise ProgramError(message, f"remove that folder, and run `mjcompose install {MUJOCO}=={version}`")
    return python


def python_of(folder: Path) -> Path:
    """Return the Python of an environment."""
    return folder / ("Scripts/python.exe" if sys.platform == "win32" else "bin/python")


def install(version: str, environment: Mapping[str, str], progress: Callable[[str], None]) -> bool:
    """Install a version, and return False if it is there already. Raises ProgramError."""
    folder = programs_folder(environment)
    with _locked(folder, version):
        place = _place(folder, version)
        if os.path.isfile(place / _READY) and untrusted_program(folder, python_of(place)) is None:
            return False
        progress(f"installing MuJoCo {version}")
        shutil.rmtree(place, ignore_errors=True)
        try:
            for command in _commands(place, version, environment):
                _install_with(command, version, environment)
            (place / _READY).touch()
        except BaseException:
            shutil.rmtree(place, ignore_errors=True)
            raise
        return True


def uninstall(version: str, environment: Mapping[str, str]) -> bool:
    """Remove a version, and return False if it is not there. Raises ProgramError."""
    folder = programs_folder(environment)
    place = _place(folder, version)
    if not os.path.lexists(place):
        return False
    with _locked(folder, version):
        (place / _READY).unlink(missing_ok=True)
        shutil.rmtree(place)
    return True


def _place(folder: Path, version: str) -> Path:
    return folder / f"{MUJOCO}-{version}"


@contextmanager
def _locked(folder: Path, version: str) -> Iterator[None]:
    """Make the folder of programs if needed, and keep other processes from changing a version. Raises ProgramError."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=0o700, exist_ok=True)
        why = _open_to_others(folder)
        if why is not None:
            raise ProgramError(f"nothing is installed into `{folder}`: {why}", f"run `chmod 700 {folder}`")
        file = os.open(folder / f"{MUJOCO}-{version}.lock", os.O_RDWR | os.O_CREAT, 0o600)
        try:
            lock_file(file)
            yield
        finally:
            os.close(file)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        message = f"the folder of programs, `{folder}`, cannot be used: {reason}"
        raise ProgramError(message, f"name another folder in `{PROGRAMS}`") from None


def untrusted_program(folder: Path, python: Path) -> str | None:
    """Return why a Python in the folder of programs is not run, or None: somebody else owns it or can change it."""
    if not hasattr(os, "geteuid"):  # a system without such owners, as Windows
        return None
    why = _open_to_others(folder)
    if why is not None:
        return why
    inner = [path for path in (python, *python.parents) if path.is_relative_to(folder)]
    for path in inner:
        try:
            if os.lstat(path).st_uid != os.geteuid():
                return f"`{path}` belongs to another user"
        except OSError as error:
            return f"the owner of `{path}` cannot be determined: {(error.strerror or str(error)).lower()}"
    real = Path(os.path.realpath(python))
    return next(filter(None, map(_changeable, (real, *real.parents))), None)


def _open_to_others(folder: Path) -> str | None:
    """Return why a folder is not the user's alone, or None."""
    if not hasattr(os, "geteuid"):
        return None
    try:
        status = os.lstat(folder)
    except OSError as error:
        return f"the owner of `{folder}` cannot be determined: {(error.strerror or str(error)).lower()}"
    if not stat.S_ISDIR(status.st_mode):
        return f"`{folder}` is not a folder"
    if status.st_uid != os.geteuid():
        return f"`{folder}` belongs to another user"
    return f"others may use `{folder}`" if status.st_mode & 0o077 else None


def _changeable(path: Path) -> str | None:
    """Return why somebody else can change or replace a file or a folder, or None. Root may own it."""
    try:
        status = os.lstat(path)
    except OSError as error:
        return f"the owner of `{path}` cannot be determined: {(error.strerror or str(error)).lower()}"
    if status.st_uid not in (0, os.geteuid()):
        return f"`{path}` belongs to another user"
    # In a sticky folder, such as that for temporary files, nobody replaces the files of others.
    is_sticky = stat.S_ISDIR(status.st_mode) and status.st_mode & stat.S_ISVTX
    # Many systems give each user a group of the same number, with no other member.
    is_private = status.st_gid == os.getgid() == os.geteuid()
    others = stat.S_IWOTH | (0 if is_private else stat.S_IWGRP)
    return f"others may write to `{path}`" if status.st_mode & others and not is_sticky else None


def _commands(folder: Path, version: str, environment: Mapping[str, str]) -> list[list[str]]:
    """Return the commands that install it: with uv if it exists, else with this Python and pip."""
    packages = [f"{MUJOCO}=={version}", "numpy"]
    python = str(python_of(folder))
    uv = program("uv", environment)
    if uv is not None:
        settings = _settings_of_uv(environment)
        # All versions since 3.0 have a wheel for this Python.
        make = [uv, *settings, "venv", "--quiet", "--python", "3.11", str(folder)]
        return [make, [uv, *settings, "pip", "install", "--quiet", "--python", python, *packages]]
    quiet = ["--quiet", "--disable-pip-version-check", "--no-input", "--only-binary", ":all:"]
    install = isolated(python, ["-m", "pip", "install", *quiet, *packages])
    return [isolated(sys.executable, ["-m", "venv", str(folder)]), install]


def _settings_of_uv(environment: Mapping[str, str]) -> list[str]:
    """Return the options for the settings of the user alone: uv would search all folders above its own."""
    if os.path.isabs(environment.get("UV_CONFIG_FILE", "")):
        return []
    if sys.platform == "win32":
        folder = environment.get("APPDATA", "")
    else:
        named = environment.get("XDG_CONFIG_HOME", "")
        folder = named if os.path.isabs(named) else os.path.expanduser("~/.config")
    file = os.path.join(folder, "uv", "uv.toml")
    return ["--config-file", file] if os.path.isabs(file) and os.path.isfile(file) else ["--no-config"]


_OF_THE_USER = re.compile(
    r"PATH|HOME|USER|LOGNAME|LANG|LC_ALL|TMPDIR|TEMP|TMP|NETRC"
    r"|USERPROFILE|APPDATA|LOCALAPPDATA|PROGRAMDATA|SYSTEMROOT|SYSTEMDRIVE|COMSPEC|PATHEXT|PROCESSOR_ARCHITECTURE"
    r"|XDG_(CACHE|CONFIG|DATA)_HOME|SSL_CERT_(FILE|DIR)|(REQUESTS|CURL)_CA_BUNDLE|(HTTPS?|ALL|NO)_PROXY"
    r"|PIP_((EXTRA_)?INDEX_URL|TRUSTED_HOST|(CLIENT_)?CERT|PROXY|FIND_LINKS|NO_INDEX|CACHE_DIR|CONFIG_FILE"
    r"|(DEFAULT_)?TIMEOUT|RETRIES|KEYRING_PROVIDER)"
    r"|UV_((DEFAULT_|EXTRA_)?INDEX(_URL)?|INDEX_\w+_(USERNAME|PASSWORD)|FIND_LINKS|NO_INDEX|INSECURE_HOST"
    r"|CACHE_DIR|CONFIG_FILE|NATIVE_TLS|SYSTEM_CERTS|OFFLINE|HTTP_TIMEOUT|KEYRING_PROVIDER"
    r"|PYTHON_(INSTALL_DIR|INSTALL_MIRROR|DOWNLOADS))",
    re.IGNORECASE,
)
"""The variables that an installer gets: who the user is, and how the user reaches which index of packages."""


def installer_environment(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables for an installer. Relative paths in them lead into its empty folder. No I/O.

    >>> installer_environment({"PIP_INDEX_URL": "https://example.org", "PIP_TARGET": "x", "PYTHONPATH": "."})
    {'PIP_INDEX_URL': 'https://example.org'}
    """
    return {name: value for name, value in environment.items() if _OF_THE_USER.fullmatch(name)}


def _install_with(command: list[str], version: str, environment: Mapping[str, str]) -> None:
    help = "install it into an environment yourself, and name its Python with `--with-python`"
    try:
        with Process(command, env=installer_environment(environment), stdout=DEVNULL, stderr=PIPE) as process:
            _, said = process.finish(seconds=_INSTALLING, most=0)
    except Overrun as overrun:
        raise ProgramError(f"MuJoCo {version} cannot be installed: {overrun}", help) from None
    if process.returncode:
        lines = [line for line in said.decode("utf-8", "replace").splitlines() if line.strip()]
        errors = [line for line in lines if "error" in line.lower()] or lines
        why = errors[-1].strip()[:_LONGEST] if errors else "without a reason"
        raise ProgramError(f"MuJoCo {version} cannot be installed: {why}", help)
