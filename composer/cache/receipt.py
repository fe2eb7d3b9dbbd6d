"""What a command leaves behind that went well, so that it is told again without being run (`again.py`)."""

from __future__ import annotations

import contextlib
import json
import os
import struct
import zipfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from composer.bundle.packing import HEAD_SIZE, level_of
from composer.cache.again import FILE, key_of_command
from composer.cache.cache import Answer, Cache, packed_key
from composer.cache.entry import KeptFile, Record
from composer.cache.outputs import is_written
from composer.cache.tool import tool_stamp
from composer.sources import blobs

Told = tuple[bool, str]
"""What was printed, and whether to standard error."""

_LOCAL_HEADER = struct.Struct("<26xHH")


@dataclass(frozen=True, slots=True)
class Output:
    """What was written: where, what its content is called, and what is told where it has to be written again.

    `record` is that of a model whose output can be put together from the store.
    """

    path: str
    content: str
    told_if_written: Sequence[Told]
    record: Record | None


def note(
    cache: Cache,
    arguments: Sequence[str],
    environment: Mapping[str, str],
    answers: Iterable[Answer | None],
    more_inputs: Iterable[Path],
    told: Sequence[Told],
    output: Output | None = None,
) -> None:
    """Remember what a command told, `answers` being all that it depends on besides `more_inputs`.

    Nothing is remembered where an answer is missing or the store refused something, or where a file was written too
    lately for its stamp to tell whether it is the same.
    """
    known = list(answers)
    whole = [each for each in known if each is not None]
    if len(whole) != len(known) or cache.broken:
        return
    seen = [each for answer in whole for each in answer.inputs]
    seen += [cache.files.look(os.path.abspath(path)) for path in more_inputs]
    folders = {each.path for each in seen if os.path.isdir(each.path)}
    if any(each.state and each.stamp is None and each.path not in folders for each in seen):
        return
    pieces = None
    if output is not None:
        if output.record is not None:
            with contextlib.suppress(OSError, KeyError, struct.error, zipfile.BadZipFile):
                pieces = _pieces(output.path, output.record)
        if not is_written(cache.store.folder, output.path, output.content):
            return
    receipt = {
        "tool": tool_stamp(),
        "inputs": [[each.path, each.stamp, each.state if each.path in folders else None] for each in seen],
        "packages": [file for answer in whole for _, _, file in answer.packages],
        "used": [each for answer in whole for each in cache.used(answer)],
        "told": told,
        "told_if_written": None if output is None else output.told_if_written,
        "out": None if output is None else [output.path, output.content],
        "pieces": pieces,
    }
    text = json.dumps(receipt, ensure_ascii=True).encode()
    with contextlib.suppress(OSError):  # told where a model is kept
        blobs.put(cache.store.folder, "asked", key_of_command(arguments, environment), text)


def _pieces(out: str, record: Record) -> list[Any] | None:
    """The output as bytes of its own and those that are elsewhere, in order."""
    if record.text is not None:
        return [["raw", record.text, 0, os.path.getsize(out)]]
    kept = {file.path: file for file in record.files}
    found: list[Any] = []
    with zipfile.ZipFile(out) as archive, open(out, "rb") as stream:
        at = 0
        for info in sorted(archive.infolist(), key=lambda each: each.header_offset):
            stream.seek(info.header_offset)
            start = info.header_offset + 30 + sum(_LOCAL_HEADER.unpack(stream.read(_LOCAL_HEADER.size)))
            stream.seek(at)
            found += [stream.read(start - at).hex(), [*_place(kept[info.filename]), info.compress_size]]
            at = start + info.compress_size
        stream.seek(at)
        found.append(stream.read().hex())
    return found


def _place(file: KeptFile) -> list[Any]:
    """Where the bytes are that an archive has of a file."""
    level = level_of(file.path)
    if level:
        return ["packed", packed_key(file.sha256, level), HEAD_SIZE]
    return ["raw", file.sha256, 0] if file.source is None else [FILE, [file.source, file.sha256], 0]
