"""Pages of models, for the tests of a browser."""

from __future__ import annotations

import base64
import json
import re
import zlib
from contextlib import ExitStack
from pathlib import Path

from mjcompose.mujoco.engine import Session
from mjcompose.sides.operand import as_recipe, read_operand
from mjcompose.sides.side import load
from mjcompose.sources.context import Context
from mjcompose.tools.view.page import write_page


def page_of(target: str, folder: Path, session: Session, key: str | None = None, *, physics: bool = False) -> Path:
    """The page of a target in a folder; with `physics` it can be played."""
    context = Context(folder=folder)
    with ExitStack() as opened:
        operand = read_operand(target, context, opened)
        assert operand is not None, context.sink.diagnostics
        if physics:
            operand = as_recipe(operand, opened)
        side = load(operand, "page", session, whole=physics)
        assert side is not None, operand.context.sink.diagnostics
        assert write_page(side, Path("page.html"), key, operand.context, session)
    return folder / "page.html"


def unpacked(page: str) -> list[str]:
    """The descriptions of the models in a page, as JSON."""
    found = []
    for data in re.findall(
        r"<script type=\"application/octet-stream\" class=(?:model|physics)[^>]*>(.*?)</script>", page, re.DOTALL
    ):
        head, _, rest = zlib.decompress(base64.b64decode(data)).partition(b"\n")
        found.append(rest[: json.loads(head)[0]].decode())
    return found
