"""`-o/--output`: the place of a command's output."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click


def output_option(help: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Return the option; the command gets it as `out`, None if it is not given."""
    return click.option("-o", "--output", "out", metavar="OUT", help=help)
