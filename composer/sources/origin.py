"""The unit that a source belongs to: what is fetched or installed as a whole, and pinned by a lock."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path

from composer.dataclass import dataclass
from composer.sources.kind import Kind


@dataclass(frozen=True, slots=True)
class Origin:
    """A repository at a commit, an archive, a robot of Menagerie, or an installed package.

    `id` is the model reference without the file (`git+https://host/repo@v1`); `root` is the folder that file names
    are relative to. `commit` and `tree` are git's hashes, `sha256` that of an archive. `without` has the paths that
    were left out when it was fetched, each with a description; `stored` has the sha256 of every file as it was put
    into the store.
    """

    id: str
    kind: Kind
    root: Path
    commit: str | None = None
    tree: str | None = None
    sha256: str | None = None
    without: tuple[tuple[str, str], ...] = ()
    stored: Mapping[str, str] = field(default_factory=dict, compare=False, repr=False)

    def __post_init__(self) -> None:
        self.kind.check_pinned(commit=self.commit, tree=self.tree, sha256=self.sha256)

    @property
    def is_fetched(self) -> bool:
        """Whether its files are in the store, separate from all other files of this machine."""
        return self.kind.is_fetched

    def named(self, inside: str) -> str:
        """Return the reference to a file in it, by its path from `root`."""
        return f"{self.id}{self.kind.separator}{inside}"

    @property
    def pin(self) -> str | None:
        """The commit or sha256 that fetches the same bytes again; None for an installed package."""
        return self.commit or self.sha256


_COMMIT = re.compile(r"[0-9a-f]{40}([0-9a-f]{24})?")


def is_commit(text: str) -> bool:
    """Return whether a text is a full commit hash. No I/O."""
    return _COMMIT.fullmatch(text) is not None
