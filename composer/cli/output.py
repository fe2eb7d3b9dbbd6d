"""`-o/--output`: where a command writes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click


def output_option(help: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """The option; the command gets it as `out`, None where it was not given."""
    return click.option("-o", "--output", "out", metavar="OUT", help=help)
