"""Source files that were read, kept between analyses for as long as they do not change."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from composer.compose.load import Key, Library
from composer.lsp.files import Mark, marks
from composer.tree.unit import Unit

_MOST = 64
"""How many units are kept: a workspace has many recipes, and memory is bounded."""


class Shelf:
    """A `Library` that drops what has changed."""

    def __init__(self) -> None:
        self.library: Library = {}
        self._marks: dict[Key, dict[Path, Mark]] = {}

    def refresh(self, texts: Mapping[str, bytes]) -> None:
        """Drop the units of which a file has changed. `texts` are the unsaved texts of editors."""
        for key in [key for key, before in self._marks.items() if marks(before, texts) != before]:
            del self._marks[key]
            self.library.pop(key, None)

    def note(self, texts: Mapping[str, bytes]) -> None:
        """Record the marks of the units that were read since the last call."""
        for key, unit in self.library.items():
            if key not in self._marks:
                self._marks[key] = marks(_files(key, unit), texts)
        for key in list(self.library)[: max(0, len(self.library) - _MOST)]:
            del self.library[key]
            self._marks.pop(key, None)


def _files(key: Key, unit: Unit) -> set[Path]:
    """Return the file of a unit and those that it includes. Texts without a path of their own belong to their file."""
    return {
        key[0],
        *(text.path or Path(name) for name, text in unit.origins.texts.items()),
    }
