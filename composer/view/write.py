"""Write the page of one model to a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError
from composer.bundle.staging import staged_file
from composer.context import Context
from composer.diff.side import Side
from composer.view.description import described
from composer.view.page import alone

if TYPE_CHECKING:
    from composer.engine import Session


def write_page(side: Side, out: Path, key: str | None, context: Context, session: Session) -> int | None:
    """Write the page of a model that `session` keeps; return its size in bytes, or None after an error.

    Errors are reported. `key` is the initial keyframe; the default is the first. If the side has its bundle, the
    page can simulate it.
    """
    made = described(side, session, key_named=key)
    if made is None or not made.has_key(key, context.sink):
        return None
    text = alone(made, played=None if side.bundle is None else _model_of(side.bundle)).encode()
    try:
        with staged_file(context.folder / out, "--html", inputs=side.inputs) as stage:
            stage.write_bytes(text)
    except OutputError as error:
        context.sink.add(error.diagnostic)
        return None
    return len(text)


def _model_of(bundle: Bundle) -> dict[str, bytes]:
    """Return the files of a bundle that MuJoCo reads, without those that reveal their origin."""
    used = {name: content for name, content in bundle.files.items() if name.startswith("assets/")}
    return {"model.xml": bundle.files[bundle.model], **used}
