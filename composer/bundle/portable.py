"""Name files independently of the machine: relative to the recipe, or by the reference of their origin."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Iterable
from pathlib import Path

from composer.context import Context, as_text
from composer.diagnostics.span import Span
from composer.reading.folders import real_path
from composer.sources.origin import Origin
from composer.sources.source import Source
from composer.tree.unit import Unit


class Portable:
    """Names the files of one composition: the recipe, its `sources`, and the `fetched` origins of its recipes."""

    def __init__(
        self,
        recipe: Path,
        sources: Iterable[Source],
        fetched: Iterable[Origin | None],
        model: Unit,
        context: Context,
    ) -> None:
        self.folder = Path(real_path(recipe.parent))
        self.sources = tuple(sources)
        origins = (*fetched, *(each.origin for each in self.sources))
        found = {each.id: each for each in origins if each is not None}
        self.origins = [(Path(real_path(each.root)), each) for each in found.values()]
        self.context = context
        self.texts = model.origins.texts
        self.named: dict[Path, str] = {}
        self.models = dict.fromkeys(
            (each.path.parent, posixpath.dirname(each.reference.replace("\\", "/")))
            for each in self.sources
            if each.origin is None
        )

    def name(self, path: Path) -> str:
        """Return the name of a file: `models/arm.xml`, `menagerie:franka_emika_panda/panda.xml`.

        A file that is neither below the recipe nor part of an origin is named relative to the reference of its
        model, as the recipe writes it.
        """
        known = self.named.get(path)
        if known is None:
            known = self.named[path] = as_text(self._name(path))
        return known

    def _name(self, path: Path) -> str:
        real = Path(real_path(path))
        if (origin := self.origin_of(real)) is not None:
            root, known = origin
            inside = real.relative_to(root).as_posix()
            return known.named(inside)
        if real.is_relative_to(self.folder):
            return real.relative_to(self.folder).as_posix()
        return self._beside(real)

    def origin_of(self, real: Path) -> tuple[Path, Origin] | None:
        """Return the origin of a file; the innermost if origins are nested."""
        around = [each for each in self.origins if real.is_relative_to(each[0])]
        return max(around, key=lambda each: len(str(each[0])), default=None)

    def place(self, span: Span) -> str:
        """Return a place in a source or a recipe as FILE:LINE."""
        return f"{self.name(self.path(span.file))}:{span.line}"

    def text(self, message: str) -> str:
        """Return a message with portable names for its files."""
        for shown in sorted(self.texts, key=len, reverse=True):
            if shown in message:
                message = message.replace(shown, self.name(self.path(shown)))
        return message

    def texts_on_disk(self) -> list[Path]:
        """Return the models and recipes that the composition was read from, if they are files."""
        return [path for shown in self.texts if os.path.isfile(path := self.path(shown))]

    def path(self, shown: str) -> Path:
        """Return the file of that name in messages."""
        return self.context.folder / shown

    def _beside(self, real: Path) -> str:
        """Return a name that goes through the nearest model with a path reference."""
        near: tuple[int, str] | None = None
        for folder, written in self.models:
            way = Path(os.path.relpath(real, real_path(folder))).as_posix()
            if near is None or way.count("../") < near[0]:
                near = (way.count("../"), posixpath.normpath(posixpath.join(written, way)))
        return real.name if near is None else near[1]
