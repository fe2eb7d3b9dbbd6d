"""The inputs of a run from outside, which are passed to every stage and never global."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import field
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from mjcompose.base.access import Door, door_of_user
from mjcompose.base.dataclass import Struct
from mjcompose.base.diagnostic import log
from mjcompose.base.sink import Sink

if TYPE_CHECKING:
    from mjcompose.base.diagnostic import Diagnostic, Span
    from mjcompose.sources.fetching import Fetching
    from mjcompose.sources.reference import Source, Trust
    from mjcompose.text.node import Node


class ReadRecipe(Struct):
    """A recipe file that was read, merged over the recipes that it extends, with its diagnostics.

    `extended` are the recipes that it extends, each with the place that names it. `said` has the `angle` and `eulerseq`
    of each of these files, by the file's name in messages. `trust` is the union of their `trust`.
    """

    node: Node | None
    found: tuple[Diagnostic, ...]
    extended: tuple[tuple[Source, Span], ...]
    said: Mapping[str, Node]
    trust: Trust


class Context(Struct, frozen=False):
    """The environment variables, the folder that displayed paths start from, the diagnostics, and the fetching rules.

    `recipes` are the recipe files read in this run, each read once. `concrete` caches their latest expansions with
    given values, with their diagnostics (`plan/concrete.py`). With `strict`, warnings that are not allowed are errors.
    `attaching` says that MJCF attaches the recipe, which then has no more rights than the MJCF. With `as_designed`,
    recipes do not use their files of measurements. `timings` has the seconds of each stage, in the order in which they
    ended.
    """

    sink: Sink = field(default_factory=Sink)
    environment: Mapping[str, str] = field(default_factory=lambda: dict(os.environ))
    folder: Path = field(default_factory=Path.cwd)
    fetching: Fetching | None = None
    recipes: dict[Path, ReadRecipe] = field(default_factory=dict)
    concrete: dict[tuple[object, ...], tuple[Any, tuple[Diagnostic, ...]]] = field(default_factory=dict)
    strict: bool = False
    attaching: bool = False
    as_designed: bool = False
    timings: list[tuple[str, float]] = field(default_factory=list)

    @contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Note the time of the block, and log it."""
        start = perf_counter()
        yield
        seconds = perf_counter() - start
        self.timings.append((stage, seconds))
        log("%s: %.3f s", stage, seconds, level=10)

    def door_of_text(self, folder: Path) -> Door:
        """Return the door of a recipe in a folder, for its own paths."""
        return door_of_user() if self.fetching is None else self.fetching.door_of_text(folder)

    def shown(self, path: Path) -> str:
        """Return a path as messages name it: relative to the user's folder if it is below that."""
        absolute = os.path.abspath(os.path.join(self.folder, path))
        below = os.path.join(self.folder, "")
        if absolute.startswith(below):
            return absolute[len(below) :]  # the result of `relpath`, in a tenth of its time
        relative = os.path.relpath(absolute, self.folder)
        return absolute if relative.startswith("..") else relative


def as_text(name: str) -> str:
    r"""Return a file's name as text: bytes that are not UTF-8, which some file systems allow, are replaced.

    >>> as_text("caf\udce9")
    'caf�'
    """
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
