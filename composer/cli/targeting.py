"""The option `--target` of `build`."""

from __future__ import annotations

import click

from composer.targets.names import MUJOCO, NAMES

target_option = click.option(
    "--target",
    type=click.Choice(NAMES),
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
            "output-kind", f"`--target` writes files of its own, which one {kind} has not", help
        )
    if not is_verified:
        help = "leave `--no-verify` out"
        raise OutputError("output-kind", "`--target` is made of the compiled model", help)
