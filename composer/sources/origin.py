"""What a source belongs to: the thing that was fetched or installed as one, and that a lock pins."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from composer.sources.kind import Kind


@dataclass(frozen=True, slots=True)
class Origin:
    """A repository at a commit, an archive, a robot of Menagerie, an installed package.

    `id` is the model reference without the file in it (`git+https://host/repo@v1`); `root` the folder against
    which its files are named. `commit` and `tree` are git's hashes, `sha256` that of an archive. `without` has the
    paths that were left out when it was fetched, and what they are in words; `stored` the sha256 of every file as it
    was put into the store.
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
        """Whether it is in the store, and none of the files of this machine has to do with it."""
        return self.kind.is_fetched

    def named(self, inside: str) -> str:
        """The reference to a file in it, by its path from `root`."""
        return f"{self.id}{self.kind.separator}{inside}"

    @property
    def pin(self) -> str | None:
        """What fetches the same bytes again; None for what somebody else installed."""
        return self.commit or self.sha256


_COMMIT = re.compile(r"[0-9a-f]{40}([0-9a-f]{24})?")


def is_commit(text: str) -> bool:
    """Whether a text is the whole hash of a commit. No I/O."""
    return _COMMIT.fullmatch(text) is not None
