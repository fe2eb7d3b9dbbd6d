"""A diff as data, for JSON."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from composer.compiled.quantities import quantity, unit
from composer.diff.change import Change, Diff, End
from composer.diff.words import relative


def as_data(diff: Diff) -> dict[str, Any]:
    """Return everything, element by element; spans have file, line and column. Values are in MuJoCo's units."""
    contrast = diff.contrast
    return {
        "same": diff.same,
        "identical": contrast.identical,
        "a": _end(diff.a),
        "b": _end(diff.b),
        "files": list(diff.files),
        "counts": [asdict(each) for each in contrast.counts],
        "groups": [
            {
                "cause": None if group.cause is None else asdict(group.cause),
                "changes": [_change(each) for each in group.changes],
            }
            for group in diff.groups
        ],
        "addresses": [asdict(each) for each in contrast.moves],
        "arrays": list(contrast.arrays),
        "follows": diff.follows,
        "views": [asdict(each) for each in diff.views],
    }


def _end(end: End) -> dict[str, Any]:
    data: dict[str, Any] = {"name": end.label, "kind": end.kind, "sha256": end.sha256}
    if end.outside:
        data["outside"] = list(end.outside)
    if end.cell is not None:
        data["cell"] = end.cell
    elif end.cells:
        data["cells"] = end.cells
    return data


def _change(change: Change) -> dict[str, Any]:
    data: dict[str, Any] = {"what": change.what, "kind": change.kind, "name": change.name}
    if change.what == "renamed":
        data["before"] = change.before
    if change.what == "changed":
        data |= {
            "quantity": quantity(change.field).words,
            "field": change.field,
            "before": change.before,
            "after": change.after,
            "unit": unit(change.field, change.form) or None,
            "relative": relative(change.before, change.after),
        }
        if change.note:
            data["note"] = change.note
        if change.entry:
            data["entry"] = change.entry
    return data
