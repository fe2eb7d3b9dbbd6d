"""Read ordinary files; pipes, devices and other files that could block are refused at once."""

from __future__ import annotations

import os
import stat

from composer.limits import written
from composer.reading.refused import Refused
from composer.reading.unsaved import unsaved_text

# Opening does not wait for the other end of a pipe, and does not acquire a controlling terminal.
_FLAGS = (
    os.O_RDONLY
    | getattr(os, "O_BINARY", 0)
    | getattr(os, "O_NONBLOCK", 0)
    | getattr(os, "O_NOCTTY", 0)
    | getattr(os, "O_CLOEXEC", 0)
)
_KINDS = (
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


class TooLarge(OSError):
    """A file with more bytes than allowed; `size` is its size, or how many bytes were read."""

    def __init__(self, size: int, most: int, what: str = "it is") -> None:
        super().__init__(f"{what} larger than {written('xml-size', most)}")
        self.size = size


def is_irregular(path: str) -> str | None:
    """Return why a path is neither a file nor a folder; None if it is one or does not exist."""
    try:
        return _irregular(os.stat(path).st_mode)
    except (OSError, ValueError):  # reported where it is read
        return None


def _irregular(mode: int) -> str | None:
    if stat.S_ISREG(mode) or stat.S_ISDIR(mode):
        return None
    what = next((words for test, words in _KINDS if test(mode)), "no file")
    return f"is {what}, not an ordinary file"


def read_regular(path: str | os.PathLike[str], most: int | None = None) -> bytes:
    """Return the bytes of an ordinary file, or the text of an editor that has not saved it.

    Raises Refused for other kinds of files, and OSError, also for more than `most` bytes.
    """
    text = os.fspath(path)
    if (kept := unsaved_text(text)) is not None:
        _bound(len(kept), most)
        return kept
    if (what := is_irregular(text)) is not None:
        raise Refused(text, what)
    file = os.open(text, _FLAGS)
    try:
        status = os.fstat(file)
        if (what := _irregular(status.st_mode)) is not None:  # replaced since the first check
            raise Refused(text, what)
        size = status.st_size
        _bound(size, most)
        data = piece = os.read(file, size + 1)
        while piece and len(data) != size:  # a file that is growing, or too large for one call
            piece = os.read(file, 1 << 20)
            data += piece
            _bound(len(data), most)
        return data
    finally:
        os.close(file)


def _bound(size: int, most: int | None) -> None:
    if most is not None and size > most:
        raise TooLarge(size, most)
