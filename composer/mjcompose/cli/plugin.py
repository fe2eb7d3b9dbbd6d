"""`mjcompose plugin`: let programs without Python open recipes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import click

from mjcompose.base.dataclass import dataclass
from mjcompose.cli.options import formats
from mjcompose.cli.reporting import USAGE
from mjcompose.cli.run import PATH, Answer, Run, Stop, command, option

Result = TypeVar("Result")


@click.group()
def plugin() -> None:
    """Let MuJoCo open recipes in every program that loads its plugins: C++ programs, Studio, ROS 2 control.

    Python programs need no plugin: use `mjcompose.spec(RECIPE)` or `mjcompose.mujoco_plugin.register()`.
    """


@dataclass(frozen=True, slots=True)
class Options:
    mujoco: Path | None = option("--mujoco", type=PATH, metavar="FOLDER", help="A MuJoCo release. Default: the package"
                                 " `mujoco` of this Python.")  # fmt: skip
    form: str = formats("text", "json")


@command(Options, within=plugin)
def install(options: Options, run: Run) -> Answer:
    """Compile the plugin and copy it to MuJoCo's plugin folder.

    It needs a C compiler and MuJoCo 4.0. It runs the mjcompose of this Python; MJCOMPOSE_PYTHON names another.
    """
    from mjcompose.tools.open import shim

    place = _done(run, lambda: shim.install(shim.mujoco_folder(options.mujoco)))
    return Answer(f"installed {place}", {"installed": str(place)}, is_outcome=True)


@command(Options, within=plugin)
def remove(options: Options, run: Run) -> Answer:
    """Remove the plugin from MuJoCo's plugin folder."""
    from mjcompose.tools.open import shim

    place = _done(run, lambda: shim.remove(shim.mujoco_folder(options.mujoco)))
    removed = None if place is None else str(place)
    return Answer(f"removed {removed}" if removed else "the plugin is not installed", {"removed": removed},
                  is_outcome=True)  # fmt: skip


def _done(run: Run, work: Callable[[], Result]) -> Result:
    from mjcompose.base.diagnostic import DiagnosticError

    try:
        return work()
    except DiagnosticError as error:
        run.context.sink.add(error.diagnostic)
        raise Stop(USAGE) from None
