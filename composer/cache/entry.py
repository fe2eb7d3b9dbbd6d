"""The stored record of a build: its diagnostics and results, and for each file its hash and where its bytes are."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import partial
from typing import Any

from composer.bundle.licence_table import Row
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Diagnostic, Note, Severity
from composer.diagnostics.fix import Fix
from composer.diagnostics.span import Span
from composer.expr.value import Value
from composer.tree.adopted import Adopted, known
from composer.verify.outcome import Outcome


@dataclass(frozen=True, slots=True)
class KeptFile:
    """A file of a bundle; `source` is an input file with the same bytes, or None if the bytes are in the store."""

    path: str
    sha256: str
    size: int
    source: str | None


@dataclass(frozen=True, slots=True)
class KeptRecipe:
    """A recipe file, its name in the manifest, and its hash at the time."""

    path: str
    name: str
    sha256: str


@dataclass(frozen=True, slots=True)
class Record:
    """A record of a successful build.

    `text` is the hash of the model's text, if only that was wanted; `mujoco` is the version that compiled it.
    `draws` are the numbers drawn for a sample, by table column; None if it is not a sample. `recipes` are the
    recipe files, the outermost first. `places` is a hash of all positions in them, and `names_places` says that the
    record contains such positions. `cells` is the number of cells of the recipe's matrix if this model is none of
    them, and `cells_at` the place of the first. `adopted` are the settings that the model takes from its parts.
    """

    name: str
    model: str
    sha256: str
    sizes: Mapping[str, int] | None
    merged: Mapping[str, Mapping[str, str]]
    files: tuple[KeptFile, ...]
    text: str | None
    mujoco: str | None
    licences: tuple[Row, ...]
    diagnostics: tuple[Diagnostic, ...]
    checks: tuple[Outcome, ...]
    draws: Mapping[str, Value] | None
    recipes: tuple[KeptRecipe, ...]
    places: str
    names_places: bool
    cells: int
    cells_at: Span | None
    adopted: tuple[Adopted, ...] = ()
    allowed: tuple[str, ...] = ()
    excluded: int = 0


def to_json(record: Record) -> bytes:
    data = asdict(replace(record, adopted=()))
    data["adopted"] = [(*each[:3], asdict(each.span), each.is_written) for each in record.adopted]
    # `default` is for sets.
    return json.dumps(data, ensure_ascii=True, default=sorted).encode()


def from_json(text: bytes) -> Record:
    """Parse what `to_json` returned. Raises ValueError, KeyError and TypeError for anything else."""
    data: dict[str, Any] = json.loads(text)
    data["files"] = tuple(KeptFile(**each) for each in data["files"])
    data["recipes"] = tuple(KeptRecipe(**each) for each in data["recipes"])
    data["licences"] = tuple(Row(**{**each, "files": tuple(each["files"])}) for each in data["licences"])
    data["diagnostics"] = tuple(map(_diagnostic, data["diagnostics"]))
    data["checks"] = tuple(
        Outcome(
            each["name"],
            each["kind"],
            Span(**each["span"]),
            diagnostics=tuple(map(_diagnostic, each["diagnostics"])),
            values=each["values"],
        )
        for each in data["checks"]
    )
    data["cells_at"] = _span(data["cells_at"])
    data["adopted"] = tuple(
        Adopted(path, value, tuple(parts), at=partial(known, Span(**span)), is_written=is_written)
        for path, value, parts, span, is_written in data["adopted"]
    )
    data["allowed"] = tuple(data["allowed"])
    return Record(**data)


def _diagnostic(data: dict[str, Any]) -> Diagnostic:
    notes, others = (
        tuple(Note(each["message"], _span(each["span"])) for each in data[kind])
        for kind in ("notes", "others")
    )
    return Diagnostic(
        data["code"],
        data["message"],
        _span(data["span"]),
        severity=Severity(data["severity"]),
        notes=notes,
        help=data["help"],
        others=others,
        subjects=frozenset(data["subjects"]),
        fix=_fix(data["fix"]),
    )


def _fix(data: dict[str, Any] | None) -> Fix | None:
    return None if data is None else Fix(data["replacement"], data["replaces"], _span(data["span"]))


def _span(data: dict[str, Any] | None) -> Span | None:
    return None if data is None else Span(**data)
