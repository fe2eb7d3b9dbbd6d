"""`--limit` and `--timeout`: limits of a command."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import click

from composer.cli import completing
from composer.cli.amount import Amount
from composer.cli.own_memory import LEAST, bound
from composer.limits import NAMES, allow, read

_EXAMPLES = {"bytes": "2G", "seconds": "600", "": "50000"}


def limit_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--limit NAME=VALUE`, which is no argument of the command: see `composer.limits.in_force`."""
    return click.option("--limit", multiple=True, metavar="NAME=VALUE", expose_value=False, callback=_limits,
                        shell_complete=completing.limits,
                        help="Change a limit, for example expansion=50000.")(command)  # fmt: skip


def timeout_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add `--timeout`, which is short for `--limit time=`, and `--limit` itself."""
    return limit_option(
        click.option("--timeout", type=Amount(min=0, min_open=True), default=None, expose_value=False,
                     callback=_time, metavar="SECONDS",
                     help="The most time that MuJoCo may take for a model; the same as --limit time=SECONDS."
                          "  [default: 300]")(
            command)
    )  # fmt: skip


def _limits(ctx: click.Context, parameter: click.Parameter, given: tuple[str, ...]) -> None:
    for each in given:
        name, _, text = each.partition("=")
        if name not in NAMES:
            from composer.diagnostics.suggest import closest

            near = closest(name, NAMES)
            meant = f" Did you mean `{near[0]}`?" if near else f" There are: {', '.join(NAMES)}."
            raise click.BadParameter(f"the limit `{name}` does not exist.{meant}", ctx, parameter)
        value = read(name, text)
        if value is None:
            example = _EXAMPLES[NAMES[name].metadata["unit"]]
            raise click.BadParameter(f"`{each}` gives no value: write `{name}={example}`.", ctx, parameter)
        if name == "memory" and value < LEAST:
            raise click.BadParameter(
                f"`{each}` is not enough: a build needs at least {LEAST >> 20}M.", ctx, parameter
            )
        ctx.with_resource(allow(**{NAMES[name].name: value}))
        if name == "memory":
            bound(int(value))


def _time(ctx: click.Context, parameter: click.Parameter, given: float | None) -> None:
    if given is not None:
        ctx.with_resource(allow(time=given))
