"""Read ordinary files; pipes, devices and other files that could block are refused at once."""

from __future__ import annotations

import errno
import os
import stat
from io import BufferedReader

from composer.limits import in_force, written
from composer.reading import sources
from composer.reading.refused import Refused
from composer.reading.unsaved import keep_piped, unsaved_text

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

    def __init__(self, size: int, most: int, what: str = "it is", path: str | None = None) -> None:
        super().__init__(f"{what} larger than {written('xml-size', most)}")
        self.size, self.path = size, path


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


def read_regular(path: str | os.PathLike[str], most: int | None = None, *, is_source: bool = True) -> bytes:
    """Return the bytes of an ordinary file, or the text of an editor that has not saved it.

    A source of the run is noted: no output takes its place. Raises Refused for other kinds of files, and OSError, also
    for more than `most` bytes; without `most` the limit is that of a whole bundle.
    """
    most = in_force().output_size if most is None else most
    if (kept := unsaved_text(path)) is not None:
        _bound(len(kept), most, path)
        return kept
    file, size = _opened(path, most, is_source)
    try:
        pieces = [os.read(file, size + 1)]
        while (
            pieces[-1] and (so_far := sum(map(len, pieces))) != size
        ):  # it is growing, or too large for one call
            _bound(so_far, most, path)
            pieces.append(os.read(file, 1 << 24))
    finally:
        os.close(file)
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)


def read_argument(path: str | os.PathLike[str], most: int) -> bytes:
    """Read a file that an argument of the command names: standard input and `<(command)` are no files, and are meant.

    Returns at most one byte more than `most` of them.
    """
    text = os.fspath(path)
    if text == "/dev/stdin" or os.path.dirname(text) in ("/dev/fd", "/proc/self/fd"):
        with open(text, "rb") as stream:
            return keep_piped(text, stream.read(most + 1))
    return read_regular(path, most)


def open_regular(
    path: str | os.PathLike[str], most: int | None = None, *, is_source: bool = True
) -> BufferedReader:
    """Open an ordinary file, as `read_regular` reads it."""
    file, _ = _opened(path, in_force().output_size if most is None else most, is_source)
    return os.fdopen(file, "rb")


def _opened(path: str | os.PathLike[str], most: int, is_source: bool) -> tuple[int, int]:
    text = os.fspath(path)
    if is_source:
        sources.current().note((text,))
    if (what := is_irregular(text)) is not None:
        raise Refused(text, what)
    file = os.open(text, _FLAGS)
    try:
        status = os.fstat(file)
        if (what := _irregular(status.st_mode)) is not None:  # replaced since the first check
            raise Refused(text, what)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), text)
        _bound(status.st_size, most, text)
    except BaseException:
        os.close(file)
        raise
    return file, status.st_size


def _bound(size: int, most: int, path: str | os.PathLike[str]) -> None:
    if size > most:
        raise TooLarge(size, most, path=os.fspath(path))
