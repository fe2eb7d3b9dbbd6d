"""The text of a file that a model was read from."""

from __future__ import annotations

from pathlib import Path

from composer.dataclass import dataclass
from composer.reading.regular import read_regular
from composer.tree.start_tag import SourceText


@dataclass(eq=False, slots=True)
class FileText:
    """A file's text, for the places of its elements. Copies of a model share it, so that it is split into lines once.

    `path` is None for text that is in no file. Without `contents`, the file is read when a place is first asked for.
    """

    path: Path | None = None
    contents: bytes | str | None = None
    _split: SourceText | None = None

    def split(self) -> SourceText:
        """Return the text in lines, without any if the file cannot be read."""
        if self._split is None:
            self._split = SourceText(self._read())
        return self._split

    def _read(self) -> bytes | str:
        if self.contents is not None:
            return self.contents
        try:
            return b"" if self.path is None else read_regular(self.path)
        except OSError:
            return b""
