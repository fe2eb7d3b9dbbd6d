"""The same command once more: what it told is told again, while nothing that this depends on has changed.

A command that went well leaves a receipt (`receipt.py`). It is found by the words of the command, its folder and what
it runs in, and holds while every file has the stamp that it had: of the recipe and all it reads, of what is written, of
this package. Whatever else is the case is for the command itself to find out.

This is imported before anything else, and imports only what takes no time.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys

from composer.cache.outputs import is_another, is_written, note_written
from composer.cache.stamp import stamp_of
from composer.cache.surroundings import environment_parts, python_version
from composer.cache.tool import tool_stamp
from composer.sources import blobs
from composer.sources.store_folder import store_folder

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from typing import Any

# What decides, beside the streams themselves, how a message looks; whether the store is right; and what is in a zip.
_VARIABLES = ("NO_COLOR", "TERM", "MJCOMPOSE_CACHE_SIZE", "SOURCE_DATE_EPOCH")

FILE = "file"
"""What stands for the kind of a blob where a file of the user's has the bytes."""


def key_of_command(arguments: Sequence[str], environment: Mapping[str, str]) -> str:
    """What the receipt of a command is called, if it is given in the current folder to the streams of this process."""
    words = [*arguments]
    where = [os.getcwd(), python_version(), environment_parts(environment)]
    looks = [[name, environment.get(name)] for name in _VARIABLES]
    terminals = [stream is not None and stream.isatty() for stream in (sys.stdout, sys.stderr)]
    return blobs.key_of(["command", words, where, looks, terminals])


def told_again(arguments: Sequence[str], environment: Mapping[str, str]) -> bool:
    """Do and tell what the same command did before; False where it has to be run, and nothing was done.

    Raises OSError where a stream takes no text.
    """
    try:
        told = _done_again(arguments, environment)
    except Exception:  # the command itself will tell what it is
        return False
    if told is None:
        return False
    for is_error, text in told:
        stream: Any = sys.stderr if is_error else sys.stdout
        stream.reconfigure(errors="surrogateescape")  # names of files that are no text
        stream.write(text)
        stream.flush()
    return True


def _done_again(arguments: Sequence[str], environment: Mapping[str, str]) -> list[tuple[bool, str]] | None:
    """What is to be printed, and whether to standard error; None where the command has to be run."""
    store = store_folder(environment)
    text = blobs.get(store, "asked", key_of_command(arguments, environment))
    if text is None or not all(map(_takes_any_text, (sys.stdout, sys.stderr))):
        return None
    receipt: dict[str, Any] = json.loads(text)
    if receipt["tool"] != tool_stamp() or not _are_as_they_were(receipt["inputs"]):
        return None
    if not all(map(os.path.isfile, receipt["packages"])):
        return None
    told: list[tuple[bool, str]] = receipt["told"]
    if receipt["out"] is not None:
        out, content = receipt["out"]
        if not is_written(store, out, content):
            # A model of other values is replaced by the command itself, which says so.
            if receipt["pieces"] is None or is_another(store, out, content):
                return None
            if not _write(out, receipt["pieces"], receipt["inputs"], store):
                return None
            told = receipt["told_if_written"]
            with contextlib.suppress(OSError):  # somebody else's store, which may be read
                note_written(store, out, content)
    for kind, key in receipt["used"]:
        with contextlib.suppress(OSError):
            os.utime(os.path.join(store, kind, key))
    return told


def _takes_any_text(stream: Any) -> bool:
    return stream is not None and stream.encoding.lower() in ("utf-8", "utf8")


def _are_as_they_were(inputs: Iterable[tuple[str, list[int] | None, str | None]]) -> bool:
    """Whether all files have their stamps; None is that of a file which is not there.

    Of folders only the licences count, for outputs come and go beside them.
    """
    for path, stamp, licences in inputs:
        try:
            now = list(stamp_of(os.stat(path)))
        except (FileNotFoundError, NotADirectoryError):
            now = None
        if now != stamp and (licences is None or licences != _licences(path)):
            return False
    return True


def _licences(folder: str) -> str:
    from composer.sources.licence_name import licence_names

    return licence_names(folder)


def _write(out: str, pieces: Iterable[Any], inputs: Iterable[Any], store: str) -> bool:
    """Put an output together from the store, where nothing is or an earlier output; False where that cannot be.

    A piece is its bytes in hexadecimal; or the kind and key of a blob, or a file and its sha256, where in it the bytes
    begin, and how many they are.
    """
    from hashlib import sha256
    from pathlib import Path
    from stat import S_ISREG

    from composer.bundle.staging import staged_file

    try:
        there = os.lstat(out)
    except FileNotFoundError:
        pass
    else:
        if not S_ISREG(there.st_mode) or any(stamp and stamp[3] == there.st_ino for _, stamp, _ in inputs):
            return False
    with staged_file(Path(out)) as stage, stage.open("wb") as stream:
        for piece in pieces:
            if isinstance(piece, str):
                stream.write(bytes.fromhex(piece))
                continue
            kind, key, start, size = piece
            if kind == FILE:
                path, digest = key
                with open(path, "rb") as source:
                    content: bytes | None = source.read()
                if sha256(content or b"").hexdigest() != digest:
                    raise ValueError(path)
            else:
                content = blobs.get(store, kind, key)
            if content is None or len(content) - start != size:
                raise ValueError(key)
            stream.write(memoryview(content)[start:])
    return True
