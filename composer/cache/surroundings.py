"""What a build finds where it runs: the interpreter, and the variables that decide where models are."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

# Other values may lead to other files.
_VARIABLES = (
    "MENAGERIE_ROOT", "MENAGERIE_CACHE_DIR", "MENAGERIE_BASE_URL", "ROBOT_DESCRIPTIONS_CACHE",
    "ROBOT_DESCRIPTION_COMMIT", "PYTHONPATH", "XDG_CACHE_HOME", "HOME",
)  # fmt: skip


def python_version() -> str:
    """The interpreter, and where its packages are."""
    return f"{sys.version.split()[0]} in {sys.prefix}"


def environment_parts(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables by what a person calls them."""
    return {f"the variable `{name}`": environment[name] for name in _VARIABLES if environment.get(name)}
