"""Locks: what is read is written as it was read."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from fuzz.mutation import json_changed
from fuzz.target import Seed, Target, Tools
from mjcompose.base.sink import Sink
from mjcompose.sources.lock import Disputed, from_text, to_text

_LOCK = {
    "lock": 1,
    "sources": {
        "git+https://host/robots@v1": {
            "kind": "git",
            "commit": "0" * 40,
            "tree": "1" * 40,
            "files": {"arm.xml": "2" * 64},
        },
        "https://host/a.zip": {"kind": "archive", "sha256": "3" * 64, "files": {"x.xml": "4" * 64}},
        "package:robots": {"kind": "package", "version": "1.0", "files": {"a/b.xml": "5" * 64}},
    },
}


def _seeds(corpus: Path | None) -> Iterator[Seed]:
    text = json.dumps(_LOCK, indent=2)
    yield Seed(text.encode())
    merge = text.replace(
        '"version": "1.0"', '\n<<<<<<< ours\n"version": "1.0"\n=======\n"version": "2.0"\n>>>>>>> theirs\n'
    )
    yield Seed(merge.encode())


def check(path: Path, tools: Tools) -> str | None:
    disputes: Disputed = {}
    for merging in (None, disputes):
        sink = Sink()
        lock = from_text(path.read_bytes(), path.name, sink, merging)
        if lock is None and not sink.has_errors:
            return "refused-without-a-word"
        if lock is not None and merging is None and from_text(to_text(lock), path.name, Sink()) != lock:
            return "another-lock-when-written"
    return None


TARGET = Target("lock", ".lock", _seeds, json_changed, check)
