"""`--timeout`: how long MuJoCo may take."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from composer.cli.amount import Amount


def timeout_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """The option; the command gets the seconds as `timeout`."""
    return click.option("--timeout", type=Amount(min=0, min_open=True), default=300, show_default=True,
                        metavar="SECONDS", help="How long MuJoCo may take for each model.")(command)  # fmt: skip
