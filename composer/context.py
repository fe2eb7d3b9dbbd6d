"""What a run has from outside: handed to every stage, never global."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from composer.diagnostics.sink import Sink

if TYPE_CHECKING:
    from composer.diagnostics.diagnostic import Diagnostic
    from composer.diagnostics.span import Span
    from composer.document.node import Node
    from composer.sources.fetching import Fetching
    from composer.sources.source import Source


@dataclass(frozen=True, slots=True)
class ReadRecipe:
    """A recipe file that was read, merged over what it extends, and what was found in it.

    `extended` are the recipes that it extends, each with the place that names it; `said` has what each of all these
    files, as messages name it, says of `angle` and `eulerseq`.
    """

    node: Node | None
    found: tuple[Diagnostic, ...]
    extended: tuple[tuple[Source, Span], ...]
    said: Mapping[str, Node]


@dataclass(slots=True)
class Context:
    """The environment variables, the folder that paths are shown from, where faults go, and how to fetch.

    `recipes` is the memory of one run: the recipe files that it has read, none of which is read twice. `concrete` has
    what it made last of these and of values, with what was found (`plan/concrete.py`).
    """

    sink: Sink = field(default_factory=Sink)
    environment: Mapping[str, str] = field(default_factory=lambda: dict(os.environ))
    folder: Path = field(default_factory=Path.cwd)
    fetching: Fetching | None = None
    recipes: dict[Path, ReadRecipe] = field(default_factory=dict)
    concrete: dict[tuple[object, ...], tuple[Any, tuple[Diagnostic, ...]]] = field(default_factory=dict)

    def shown(self, path: Path) -> str:
        """A path as messages name it: from the user's folder where it is below that."""
        absolute = os.path.abspath(self.folder / path)
        relative = os.path.relpath(absolute, self.folder)
        return absolute if relative.startswith("..") else relative


def as_text(name: str) -> str:
    r"""A file's name as text: bytes that are not UTF-8, which some file systems allow, are replaced.

    >>> as_text("caf\udce9")
    'caf�'
    """
    return name.encode("utf-8", "surrogateescape").decode("utf-8", "replace")
