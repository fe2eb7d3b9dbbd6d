"""A bundle as a compiled model."""

from __future__ import annotations

import tempfile
from pathlib import Path

from composer import engine
from composer.bundle.bundle import Bundle
from composer.bundle.output_error import OutputError, unwritable
from composer.bundle.staging import staged_file, write_files


def write_mjb(
    bundle: Bundle,
    out: Path,
    *,
    limits: engine.Limits | None = None,
    session: engine.Session | None = None,
) -> None:
    """Compile the bundle and write MuJoCo's binary form, which only the same version of MuJoCo reads.

    Raises OutputError, also when the model does not compile; then an older `out` is untouched.
    """
    with staged_file(out) as stage:
        stage.touch()  # whoever may not write there learns it now, from the operating system
        try:
            with tempfile.TemporaryDirectory(prefix="mjcompose-", ignore_cleanup_errors=True) as folder:
                write_files(bundle, Path(folder))
                compiled = engine.compile(
                    Path(folder), bundle.model, mjb=stage, limits=limits, session=session
                )
        except OSError as error:
            raise unwritable("a temporary folder", error) from error
        if not compiled.ok:
            raise OutputError("output-unwritable", f"cannot write `{out}`: {compiled.error}")
