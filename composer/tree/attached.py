"""What MuJoCo itself attaches to a model: `<attach>` brings it when the model is compiled."""

from __future__ import annotations

from composer.diagnostics.diagnostic import Note
from composer.tree.unit import Unit


def attached_notes(unit: Unit, name: str) -> list[Note]:
    """Where a name that does not exist may be one that an `<attach>` brings."""
    return [
        Note(
            "it may be of the model that MuJoCo attaches here, and can only be referred to: to reach into that,"
            " attach it in a recipe",
            unit.origins.span(attach, unit.file),
        )
        for attach in unit.root.iter("attach")
        if name.startswith(str(attach.get("prefix") or ""))
    ]
