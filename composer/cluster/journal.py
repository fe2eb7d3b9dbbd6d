"""What workers with disks of their own have written, beside the models, until the client has it in its cache.

A client that is killed has not heard of its last models. The next run finds them here, compares inputs and output, and
builds none of them again. Entries are signed with a key in the store of the client, so others cannot write any.
"""

from __future__ import annotations

import contextlib
import hashlib
import hmac
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from composer.bundle.output_error import OutputError
from composer.bundle.read import ReadError, read
from composer.bundle.staging import staged_file
from composer.cache.entry import Record, from_json, to_json
from composer.cache.files import Seen, seen
from composer.dataclass import dataclass
from composer.reading.regular import read_regular
from composer.sources import blobs

if TYPE_CHECKING:
    from composer.cache.making import CellMaker
    from composer.expand.matrix import Cell

_FOLDER = ".mjcompose-cluster"
_LARGEST = 64 << 20
_READABLE = ("folder", "archive")
"""The forms of output whose contents can be compared with a record."""


@dataclass(frozen=True, slots=True)
class Journal:
    """The journal of a run, in the folder of its models; `run` is the digest of what all cells have in common."""

    folder: Path
    run: str
    key: bytes

    def note(self, cell: str, record: Record, inputs: Sequence[Seen]) -> None:
        """Note a model that is written whole; if that fails, it may be built twice."""
        data = [self.run, cell, to_json(record).decode(), [each.as_data() for each in inputs]]
        text = json.dumps(data, ensure_ascii=True).encode()
        with contextlib.suppress(OutputError, OSError), staged_file(self._place(cell)) as stage:
            stage.write_bytes(self._signed(text) + text)

    def take(self, cell: Cell, making: CellMaker, packages: Sequence[tuple[str, str, str]]) -> bool:
        """Add a model that is written whole to the cache, and forget it here; return whether there is one."""
        try:
            text = read_regular(self._place(cell.name), _LARGEST, is_source=False)
            size = len(self._signed(b""))
            if not hmac.compare_digest(self._signed(text[size:]), text[:size]):
                return False
            run, name, record_text, inputs = json.loads(text[size:])
            record = from_json(record_text.encode())
            target = making.maker.place(record.name, record.mujoco)
            if (run, name) != (self.run, cell.name) or not isinstance(target, Path):
                return False
            if making.maker.form not in _READABLE or read(target).sha256 != record.sha256:
                return False
            making.keep_record(cell, record, [seen(each) for each in inputs], packages=packages)
        except (OSError, ReadError, ValueError, TypeError, KeyError, RecursionError):
            return False
        self.forget(cell.name)
        return True

    def forget(self, cell: str) -> None:
        """Forget a model that the cache of the client has."""
        with contextlib.suppress(OSError):
            self._place(cell).unlink(missing_ok=True)

    def end(self) -> None:
        """Remove the journal if nothing is left in it."""
        with contextlib.suppress(OSError):
            (self.folder / _FOLDER).rmdir()

    def _place(self, cell: str) -> Path:
        return self.folder / _FOLDER / f"{hashlib.sha256(cell.encode()).hexdigest()[:40]}.json"

    def _signed(self, text: bytes) -> bytes:
        return hmac.new(self.key, text, hashlib.sha256).hexdigest().encode() + b"\n"


def journal_of(making: CellMaker, folder: object) -> Journal | None:
    """Return the journal of a run; None without a cache, which gets its entries, or without a folder for the models."""
    cache, key = making.maker.cache, making.maker.key()
    if cache is None or key is None or not isinstance(folder, Path) or making.finish is None:
        return None
    name = blobs.key_of(["the key of journals"])
    secret = blobs.get(cache.store.folder, "asked", name)
    if secret is None:
        secret = os.urandom(32)
        with contextlib.suppress(OSError):
            blobs.put(cache.store.folder, "asked", name, content=secret)
    return Journal(folder, key.digest, secret)
