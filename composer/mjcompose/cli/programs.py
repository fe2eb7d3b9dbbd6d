"""`install` and `uninstall`: MuJoCos of other versions, for `upgrade`, `migrate` and the check `moves_alike`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager

import click

from mjcompose.cli.options import ReportOptions
from mjcompose.cli.reporting import USAGE, progress
from mjcompose.cli.run import Answer, Group, Run, Stop, argument, command, group
from mjcompose.mujoco import programs

_PROGRAM = re.compile(rf"{programs.MUJOCO}==(\d+(?:\.\d+)*)")


def _version(context: click.Context, parameter: click.Parameter, words: tuple[str, ...]) -> tuple[str, ...]:
    """Return the versions that the words name, such as `mujoco==3.12`."""
    from mjcompose.tree.history import RELEASED, release

    versions: list[str] = []
    for word in words:
        named = _PROGRAM.fullmatch(word)
        version = None if named is None else release(named[1])
        if version is None:
            raise click.BadParameter(f"`{word}` is not `mujoco==VERSION`, from {RELEASED[0]} to {RELEASED[-1]}")
        versions.append(version)
    return tuple(dict.fromkeys(versions))


class InstallOptions(Group):
    versions: tuple[str, ...] = argument(metavar="[PROGRAM]...", nargs=-1, callback=_version)
    reporting: ReportOptions = group(ReportOptions)


@command(
    InstallOptions,
    help="""Install PROGRAM, such as mujoco==3.12, into a folder of your own. Without PROGRAM, list the installed ones.

    `upgrade`, `migrate --prove` and the check `moves_alike` use it. Nothing else installs anything. It uses uv if that
    is on your PATH, otherwise pip, with the package index in your own settings. The variable MJCOMPOSE_PROGRAMS names
    another folder.
    """,
)
def install(options: InstallOptions, run: Run) -> Answer:
    environment = run.context.environment
    lines: list[str] = []
    with _reported(run):
        for version in options.versions:
            is_new = programs.install(version, environment, progress)
            lines.append(f"{'installed' if is_new else 'already installed:'} MuJoCo {version}")
        there = programs.installed(environment)
        folder = programs.programs_folder(environment)
    rows = [{"program": f"{programs.MUJOCO}=={version}", "python": str(path)} for version, path in there.items()]
    if not options.versions:
        lines = [f"{row['program']}  {row['python']}" for row in rows] or [f"nothing is installed in {folder}"]
    return Answer("\n".join(lines), {"folder": str(folder), "installed": rows}, is_outcome=True)


class UninstallOptions(Group):
    versions: tuple[str, ...] = argument(metavar="PROGRAM...", nargs=-1, required=True, callback=_version)
    reporting: ReportOptions = group(ReportOptions)


@command(UninstallOptions, help="Remove PROGRAM, such as mujoco==3.12, which `install` has installed.")
def uninstall(options: UninstallOptions, run: Run) -> Answer:
    with _reported(run):
        removed = [each for each in options.versions if programs.uninstall(each, run.context.environment)]
    lines = [
        f"removed MuJoCo {each}" if each in removed else f"MuJoCo {each} is not installed" for each in options.versions
    ]
    rows = [f"{programs.MUJOCO}=={each}" for each in removed]
    return Answer("\n".join(lines), {"removed": rows}, is_outcome=True)


@contextmanager
def _reported(run: Run) -> Iterator[None]:
    try:
        yield
    except programs.ProgramError as error:
        run.context.sink.error("not-installed", str(error), help=error.help)
        raise Stop(USAGE) from None
