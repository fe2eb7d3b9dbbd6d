"""The refusal to read a file: the reader may not see it, or it is not an ordinary file."""

from __future__ import annotations

import errno
import os
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from pathlib import Path

    from composer.diagnostics.diagnostic import Note
    from composer.diagnostics.sink import Sink
    from composer.diagnostics.span import Span

CODE = "source-outside"
OUTSIDE = "is outside {}"


class Refused(OSError):
    """A file that a door does not admit; `why` follows its name in a message, `help` says what to do."""

    def __init__(self, path: str, why: str, help: str | None = None, real: str | None = None) -> None:
        super().__init__(errno.EACCES, why, path)
        self.path, self.why, self.help, self.real = path, why, help, real

    def message(self, shown: Callable[[Path], str] | None = None) -> str:
        """Return one sentence; `shown` returns the file's name in messages."""
        from pathlib import Path

        call = shown or str
        leads = ""
        if self.real is not None and Path(self.path).is_symlink():
            leads = f", a link to `{call(Path(self.real))}`,"
        return f"the file `{call(Path(self.path))}`{leads} {self.why}"

    def report(
        self,
        sink: Sink,
        span: Span | None,
        notes: Iterable[Note] = (),
        shown: Callable[[Path], str] | None = None,
    ) -> None:
        """Report it to the sink, at the place that names the file."""
        from pathlib import Path

        from composer.diagnostics.diagnostic import Cause

        cause = None
        if self.real is not None:  # all files of one folder have one cause
            folder = os.path.dirname(self.real)
            cause = Cause(
                f"{span.file if span else ''} {folder} {self.why}", f"`{(shown or str)(Path(self.path))}`"
            )
        sink.error(CODE, self.message(shown), span, notes=tuple(notes), help=self.help, cause=cause)
