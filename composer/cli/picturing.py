"""`build --picture`: a picture next to each written model."""

from __future__ import annotations

import os
from contextlib import ExitStack
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.beside import picture_of
from composer.bundle.place import is_address
from composer.dataclass import dataclass
from composer.diagnostics.secret import hide

if TYPE_CHECKING:
    from composer.bundle.form import Form
    from composer.context import Context
    from composer.engine import Session

_KEPT = "picture"


def check_has_picture(out: str, kind: Form) -> None:
    """Raise OutputError for outputs without pictures."""
    from composer.bundle.output_error import OutputError

    if is_address(out):
        help = "write to this machine and copy the files from there, or leave `--picture` out"
        message = f"`--picture` is for what is written to this machine, and `{hide(out)}` is an address"
        raise OutputError("output-kind", message, help)
    why = {"mjb": "MuJoCo's binary form", "usd": "USD"}.get(kind)
    if out == "-" or why is not None:
        message = f"`--picture` is for bundles and MJCF files, and `{out}` is {why or 'standard output'}"
        raise OutputError(
            "output-kind", message, "write a folder, a `.zip` or an `.xml`, or leave `--picture` out"
        )


def picture_beside(target: str, name: str) -> Path:
    """Return the path of the picture of the output `target`."""
    return Path(os.path.dirname(target.rstrip("/"))) / picture_of(name)


@dataclass(slots=True)
class Picturing:
    """Draws the pictures in one child process with a renderer, which ends with `opened`."""

    opened: ExitStack
    _session: Session | None = field(default=None)

    def put(self, target: str, name: str, *, is_known: bool, context: Context) -> None:
        """Draw the picture of the output `target`; if the output `is_known`, an existing picture stays.

        Errors go to the sink.
        """
        out = picture_beside(target, name)
        if is_known and os.path.exists(context.folder / out):
            return
        from composer.diagnostics.sink import Sink
        from composer.diff.operand import read_operand
        from composer.diff.side import load
        from composer.engine import Session
        from composer.render.render import render
        from composer.render.wish import Wish

        if self._session is None:
            self._session = self.opened.enter_context(Session(rendering=True))
        with ExitStack() as opened:
            operand = read_operand(target, replace(context, sink=Sink()), opened)
            side = None if operand is None else load(operand, _KEPT, self._session)
            if operand is None or side is None:
                context.sink.error("no-rendering", f"no picture of `{target}` can be made: it cannot be read")
            else:
                render(_KEPT, out, Wish(), context=context, session=self._session, option="--picture")
