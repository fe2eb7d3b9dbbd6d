"""A model reference that was resolved: a file on this machine, and where it came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Literal

from composer.reading.door import NOTHING, Door
from composer.sources.kind import Kind
from composer.sources.origin import Origin
from composer.sources.urdf_choices import AS_WRITTEN, UrdfChoices

Format = Literal["recipe", "mjcf", "urdf"]

FORMATS: dict[str, Format] = {
    ".yaml": "recipe",
    ".yml": "recipe",
    ".xml": "mjcf",
    ".mjcf": "mjcf",
    ".urdf": "urdf",
    ".xacro": "urdf",
}
"""What a file is, by its suffix in lower case."""


@dataclass(frozen=True, slots=True)
class Source:
    """The model file that a reference stands for.

    `reference` is as it was written. `package` and `version` name the distribution that the file came with;
    the version is None where the file need not be the one that the distribution holds; of a repository it is the
    commit, of an archive its sha256. `licences` are the licence files that go with the model, sorted by
    name, and empty when none was found. `packages` are the folders that `package://NAME` stands for
    in URDF, where the recipe gives them. `origin` is what the file belongs to, None for one that is named by its
    path. `licence` is what its package says, as an SPDX expression. `door` is what the model may read.
    `urdf` is how a URDF is to be read.
    """

    path: Path
    kind: Kind
    reference: str
    package: str | None = None
    version: str | None = None
    licences: tuple[Path, ...] = ()
    packages: tuple[tuple[str, Path], ...] = ()
    origin: Origin | None = None
    licence: str | None = None
    door: Door = field(default=NOTHING, compare=False, repr=False)
    urdf: UrdfChoices = AS_WRITTEN

    def __post_init__(self) -> None:
        belongs_to = self.kind if self.origin is None else self.origin.kind
        belongs_to.check_pinned(package=self.package)

    @property
    def format(self) -> Format:
        """What the file is, by its suffix; a file whose suffix says nothing never becomes a source."""
        return FORMATS[self.path.suffix.lower()]


def has_format(path: PurePath) -> bool:
    """Whether the suffix says that the file is a recipe, MJCF or URDF. No I/O."""
    return path.suffix.lower() in FORMATS
