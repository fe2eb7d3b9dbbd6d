"""A resolved model reference: a file on this machine, and its origin."""

from __future__ import annotations

from dataclasses import field
from pathlib import Path, PurePath
from typing import Literal, TypeAlias

from composer.dataclass import dataclass
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
"""The format of a file by its suffix in lower case."""


ReadAs: TypeAlias = tuple[Path, tuple[tuple[str, Path], ...], UrdfChoices]
"""A file, and how it is read; equal for sources that give the same model."""


@dataclass(frozen=True, slots=True)
class Source:
    """The model file of a reference.

    `reference` is the text as written. `package` and `version` name the distribution of the file; the version is
    None if the file may differ from the distribution's; for a repository it is the commit, for an archive its
    sha256. `licences` are the licence files of the model, sorted by name. `packages` are the folders for
    `package://NAME` in URDF, if the recipe gives them. `origin` is what the file belongs to, None for a plain path.
    `licence` is the SPDX expression of its package. `door` limits what the model may read.
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
        """The format of the file by its suffix; a file with another suffix never becomes a source."""
        return FORMATS[self.path.suffix.lower()]

    @property
    def read_as(self) -> ReadAs:
        return self.path, self.packages, self.urdf


def has_format(path: PurePath) -> bool:
    """Return whether the suffix is that of a recipe, MJCF or URDF. No I/O."""
    return path.suffix.lower() in FORMATS
