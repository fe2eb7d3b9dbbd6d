"""Which MuJoCo a model is written for, and which one it is to be written for."""

from __future__ import annotations

from collections.abc import Collection
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING

from composer.grammar.history import unread
from composer.grammar.version import version_key
from composer.migrate.released import RELEASED, later, release

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from composer.context import Context
    from composer.tree.unit import Unit


def installed() -> str:
    """The release that is installed here, or the last one that the table knows."""
    try:
        own = version("mujoco")
    except PackageNotFoundError:
        return RELEASED[-1]
    return release(".".join(map(str, version_key(own)))) or RELEASED[-1]


def check_installed(context: Context) -> None:
    """A warning where a MuJoCo is installed that is newer than the table."""
    try:
        own = version("mujoco")
    except PackageNotFoundError:
        return
    if version_key(own) > version_key(RELEASED[-1]):
        context.sink.warning(
            "migrate-version",
            f"MuJoCo {own} is installed, and what changed after {RELEASED[-1]} is not known",
            help="update mjcompose",
        )


def known(text: str, option: str, context: Context) -> str | None:
    """The release of a version that the user names; None where there is none, which is reported."""
    found = release(text)
    if found is None:
        context.sink.error(
            "migrate-version",
            f"`{option} {text}` is not a MuJoCo that models can be migrated from or to",
            help=f"there are {RELEASED[0]} to {RELEASED[-1]}; of `{option} 3.1` the last one is taken",
        )
    return found


def written_for(unit: Unit, after: str, others: Collection[str], context: Context) -> str | None:
    """The version that a model is written for, where nobody says it; None where it is not known, which is reported.

    `others` are the versions of the Pythons that the user names.
    """
    beside = [each for each in others if each != after]
    if len(beside) == 1:
        return known(beside[0], "--with-python", context)
    if later(installed(), after):
        return installed()
    first, last = bounds(unit.root)
    if first is None or last is None:
        says = "no MuJoCo since 3.0 reads all that is in it"
    elif last == RELEASED[-1]:
        says = f"all since {first} read it"
    else:
        says = f"those from {first} to {last} read it"
    context.sink.error(
        "migrate-version",
        f"it is not known which MuJoCo `{unit.file}` is written for: {says}",
        help=f"say it with `--from`, as in `--from {last if last and last != after else '3.3'}`;"
        " its README or the date of its last change tell",
    )
    return None


def bounds(root: Node) -> tuple[str | None, str | None]:
    """From which version to which one there is all that a tree has, as far as it shows."""
    fitting = [version for version in RELEASED if next(unread(root, version), None) is None]
    return (fitting[0], fitting[-1]) if fitting else (None, None)
