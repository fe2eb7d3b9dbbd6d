"""A bundle from anyone may read only itself: its model is asked what it names before MuJoCo has it."""

from __future__ import annotations

import os
from pathlib import Path

from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink
from composer.reading.door import Door
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file


def outside(folder: Path, model: str, shown: str) -> tuple[Diagnostic, ...]:
    """What is wrong with the files that a model names, whose bundle was written to `folder`; empty if nothing is.

    `shown` is how messages name the bundle. What cannot be read as XML is wrong too: nobody knows what it names.
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
    refused = tuple(each for each in (*sink.errors, *found.errors) if each.code == "source-outside")
    return refused or (
        () if unit is not None else tuple(each for each in sink.errors if each.code == "xml-syntax")
    )
