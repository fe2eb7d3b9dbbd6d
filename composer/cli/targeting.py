"""The option `--target` of `build`."""

from __future__ import annotations

from typing import Any

import click

from composer.targets.names import MUJOCO, NAMES


class _Target(click.Choice):  # type: ignore[type-arg]  # before click 8.2 it is not generic
    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        if value in self.choices:
            return str(value)
        from composer.diagnostics.suggest import closest

        near = closest(value, self.choices)
        hint = f" Did you mean `{near[0]}`?" if near else ""
        message = f"the target `{value}` does not exist.{hint} Targets: {', '.join(self.choices)}."
        raise click.BadParameter(message, ctx, param)


target_option = click.option(
    "--target",
    type=_Target(NAMES),
    callback=lambda context, option, value: None if value == MUJOCO else value,
    help="The program to write the model for. What it does not support is reported. Default: mujoco.",
)

_MORE = {"isaac": ("usd",)}
"""Other kinds of output that a target reads: Isaac Sim opens USD without its importer."""


def check_target(target: str | None, kind: str, *, is_verified: bool) -> None:
    """Refuse an output form that a target does not support. Raises OutputError."""
    from composer.bundle.output_error import OutputError

    if target is None:
        return
    if kind not in ("folder", "archive", *_MORE.get(target, ())):
        help = f"write a folder, `--target {target} -o build/{target}/`, or an archive"
        raise OutputError(
            "output-kind", f"a model for `{target}` is several files, and the output is one", help
        )
    if not is_verified:
        help = "leave `--no-verify` out"
        raise OutputError("output-kind", "`--target` is made of the compiled model", help)
