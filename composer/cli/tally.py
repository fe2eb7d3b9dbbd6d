"""Count the checked cells of a recipe and the failed ones, for every format."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, field
from pathlib import Path

import click

from composer.dataclass import dataclass
from composer.diagnostics import github
from composer.diagnostics.cell_name import CellName, listed
from composer.diagnostics.diagnostic import Diagnostic
from composer.diagnostics.sink import Sink


@dataclass(slots=True)
class Tally:
    """Counts the cells of a run: `total` is their number, `whole` the number of those without errors."""

    recipe: Path
    total: int
    whole: int = 0
    failed: list[CellName] = field(default_factory=list)

    def take(self, cell: CellName, found: Iterable[Diagnostic], sink: Sink, *, failed: bool) -> None:
        """Count a cell, and add its diagnostics."""
        for diagnostic in found:
            sink.add_of_cell(cell, diagnostic)
        if failed:
            self.failed.append(cell)
        else:
            self.whole += 1

    def say(self, form: str, *, err: bool = False) -> None:
        """Print the tally: always in JSON, else only if a cell failed."""
        words = self._said(form)
        if words is not None:
            click.echo(words, err=err or form == "text")

    def _said(self, form: str) -> str | None:
        if form == "json":
            answer = {
                "recipe": str(self.recipe),
                "cells": self.total,
                "failed": [asdict(each) for each in self.failed],
            }
            return json.dumps(answer)
        if not self.failed:
            return None
        words = f"{len(self.failed)} of {self.total} cells failed: {listed(self.failed)}"
        return words if form == "text" else github.command("error", words, {"title": str(self.recipe)})
