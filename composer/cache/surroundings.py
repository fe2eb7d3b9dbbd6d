"""What a build finds where it runs: the interpreter, and the variables that decide where models are."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from composer.sources.kinds import KINDS

if TYPE_CHECKING:
    from collections.abc import Mapping


def python_version() -> str:
    """The interpreter, and where its packages are."""
    return f"{sys.version.split()[0]} in {sys.prefix}"


def environment_parts(environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that decide which file a model reference stands for, by what a person calls them."""
    names = sorted({name for kind in KINDS for name in kind.variables})
    return {f"the variable `{name}`": environment[name] for name in names if name in environment}
