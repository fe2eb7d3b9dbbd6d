"""Models that MuJoCo itself attaches with `<attach>` when it compiles a model."""

from __future__ import annotations

from composer.diagnostics.diagnostic import Note
from composer.tree.unit import Unit


def attached_notes(unit: Unit, name: str) -> list[Note]:
    """Return notes on each `<attach>` that may bring a missing name."""
    return [
        Note(
            "it may be of the model that MuJoCo attaches here, and can only be referred to: to reach into that,"
            " attach it in a recipe",
            unit.origins.span(attach, unit.file),
        )
        for attach in unit.root.iter("attach")
        if name.startswith(str(attach.get("prefix") or ""))
    ]
