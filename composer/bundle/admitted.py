"""Make sure that an untrusted bundle reads only its own files, and no more of them than the limits allow.

This checks what its model names before MuJoCo opens it.
"""

from __future__ import annotations

import os
from pathlib import Path

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.reading.door import Door
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file

_CODES = ("source-outside", "limit-exceeded")


def outside(folder: Path, model: str, shown: str) -> tuple[Diagnostic, ...]:
    """Return the faults in the files that a model names, and what of it is too large; empty if there are none.

    The bundle was written to `folder`; `shown` is its name in messages. Invalid XML is a fault too, because it may
    name any file.
    """
    if not model.lower().endswith(".xml"):
        return ()
    path, sink, found = folder / model, Sink(), Sink()

    def name(file: Path) -> str:
        return f"{shown}/{Path(os.path.relpath(os.path.abspath(file), os.path.abspath(folder))).as_posix()}"

    door = Door.of([folder], f"the bundle `{shown}`, which may read only itself")
    unit = parse_file(path, sink, file=f"{shown}/{model}", door=door)
    if unit is not None:
        all_admitted(unit, found, name)
    refused = tuple(each for each in (*sink.errors, *found.errors) if each.code in _CODES)
    return refused or (
        () if unit is not None else tuple(each for each in sink.errors if each.code == "xml-syntax")
    )
