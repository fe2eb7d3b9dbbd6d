"""Find the sources of a stored bundle again. A file counts only if it has the hash in the manifest."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from composer.bundle.manifest import Input, Manifest
from composer.context import Context
from composer.diagnostics.sink import Sink
from composer.plan.planner import make_plan
from composer.reading.door import Door
from composer.reading.project import folder_of_recipe, own_door
from composer.reading.regular import read_regular
from composer.sources.error import SourceError
from composer.sources.kinds import kind_called
from composer.sources.path import KIND as PATH
from composer.sources.resolve import resolve
from composer.sources.source import Source
from composer.tree.admitted import all_admitted
from composer.tree.parse import parse_file


class Inputs:
    """The inputs of a bundle, found through its recipe if there is one, else from `context.folder`.

    Without `recipe`, a file of the recipe's name in the folder is used if its hash is that in the manifest.
    Errors in a given recipe go to the sink.
    """

    def __init__(self, manifest: Manifest, recipe: Path | None, context: Context) -> None:
        self.manifest, self.context = manifest, context
        self.given = recipe is not None
        found = recipe or self._beside()
        self.folder = context.folder if found is None else (context.folder / found).parent
        # The bundle may come from anyone, so its references may only name files of this project.
        self.door = Door.of([folder_of_recipe(self.folder / "recipe.yaml")])
        self.planned: list[Source] = []
        if found is not None:
            aside = Context(context.sink if self.given else Sink(), context.environment, context.folder)
            plan = make_plan(found, aside)
            self.planned = [] if plan is None else list(plan.sources())

    def find(self, number: int) -> Source | str:
        """Return the source of an input, or a sentence that says why there is none."""
        if number >= len(self.manifest.inputs):
            return f"the manifest has no input {number}"
        wanted = self.manifest.inputs[number]
        changed: Path | None = None
        for source in self._candidates(number, wanted):
            digest = _sha256(source.path)
            if digest == wanted.sha256:
                return source if self._is_admitted(source) else "its source names files that it may not read"
            changed = changed or (source.path if digest else None)
        if changed is not None:
            return f"`{self.context.shown(changed)}` is not the file that the bundle was built from"
        return f"its source `{wanted.reference}` is not found"

    def _is_admitted(self, source: Source) -> bool:
        """Return whether MuJoCo may open the source and its files. URDF is checked when it is converted."""
        if source.format != "mjcf":
            return True
        unit = parse_file(source.path, Sink(), door=source.door)
        return unit is not None and all_admitted(unit, Sink())

    def _beside(self) -> Path | None:
        recipe = self.manifest.recipe
        if recipe is None or Path(recipe.path).name != recipe.path:
            return None
        path = self.context.folder / recipe.path
        return path if _sha256(path) == recipe.sha256 else None

    def _candidates(self, number: int, wanted: Input) -> Iterator[Source]:
        if len(self.planned) == len(self.manifest.inputs):
            yield self.planned[number]
        kind = kind_called(wanted.kind)
        # Only the bundle asks for this reference, so nothing is fetched and no code runs.
        if kind is not None and not kind.is_fetched and not kind.runs_code:
            with suppress(SourceError):
                found = resolve(
                    wanted.reference, relative_to=self.folder, environment=self.context.environment
                )
                if found.origin is not None or self.door.sees(found.path):
                    yield found
        path = self.folder / wanted.path
        if self.door.sees(path):
            yield Source(path, kind or PATH, wanted.reference, door=own_door(path))


def _sha256(path: Path) -> str | None:
    """Return the hash of a file, or None if it does not exist."""
    try:
        return hashlib.sha256(read_regular(path)).hexdigest() if os.path.isfile(path) else None
    except (OSError, ValueError):
        return None
