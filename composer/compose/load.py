"""Step: load a source as a unit. Each file is read once and copied for every further use."""

from __future__ import annotations

from collections import Counter
from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING

from composer.context import Context
from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.link.source_check import check_source
from composer.plan.part_record import Tables
from composer.sources.source import Source
from composer.sources.urdf_choices import UrdfChoices
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file
from composer.tree.unit import Unit
from composer.tree.watch import Watch, nobody

if TYPE_CHECKING:
    from composer.engine import Session

Key = tuple[Path, tuple[tuple[str, Path], ...], UrdfChoices, bool]
"""`Source.read_as`, and whether it stands in the world."""

Library = dict[Key, Unit]
"""Units as their files have them, for all that are composed with it."""


@dataclass(slots=True)
class Loader:
    """Loads the units of source files.

    `expect` announces how often each is needed, so the last use needs no copy. Units that are in the `library` are
    not read again, and new ones are added to it. `checks` is set if every file must be valid MJCF as a whole, not
    only where the composition reads it.
    """

    context: Context
    session: Session | None = None
    watch: Watch = nobody
    library: Library | None = None
    checks: bool = False
    parsed: dict[Key, Unit | None] = field(default_factory=dict)
    uses: Counter[Key] = field(default_factory=Counter)

    def expect(self, model: Source, stands: bool) -> None:
        self.uses[key_of(model, stands)] += 1

    def unit(self, model: Source, span: Span | None, stands: bool) -> Unit | None:
        """Return the unit of a source, or None if it has faults. With `stands`, it is fixed in the world."""
        key = key_of(model, stands)
        if key not in self.parsed:
            refused = (
                self.parsed.get((*key[:3], not key[3]), ...) is None
            )  # one fault of a file is reported once
            self.parsed[key] = None if refused else self._known(key) or self._read(model, span, stands)
        unit = self.parsed[key]
        self.uses[key] -= 1
        # Linking uses a unit up.
        if unit is not None and self.uses[key] > 0:
            unit = unit.copied()
        if unit is not None:
            self.watch([unit], model)
        return unit

    def tables(self) -> Tables:
        """Return what was read of each source that is not MJCF, and what was not."""
        return {key[:3]: unit.table for key, unit in self.parsed.items() if unit is not None and unit.table}

    def _known(self, key: Key) -> Unit | None:
        unit = self.library.get(key) if self.library is not None else None
        return None if unit is None else unit.copied()

    def _read(self, model: Source, span: Span | None, stands: bool) -> Unit | None:
        unit = self._new(model, span, stands)
        if unit is not None and self.library is not None:
            self.library[key_of(model, stands)] = unit.copied()
        return unit

    def _new(self, model: Source, span: Span | None, stands: bool) -> Unit | None:
        if model.format == "urdf":
            from composer.compose.urdf import urdf_unit  # few recipes need it

            return urdf_unit(model, self.context, self.session, span=span, stands=stands)
        sink, shown = self.context.sink, self.context.shown
        unit = parse_file(model.path, sink, file=shown(model.path), span=span, door=model.door)
        if unit is None or not all_admitted(unit, sink, shown):
            return None
        if self.checks and not check_source(unit, sink):
            return None
        return unit


def key_of(model: Source, stands: bool) -> Key:
    """Return a key that is equal for sources that read the same. For MJCF, `stands` does not matter."""
    return *model.read_as, stands or model.format != "urdf"
