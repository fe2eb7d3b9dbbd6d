"""The record of one source model in a composition, for comparing the two."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeAlias

from composer.dataclass import dataclass
from composer.numerics.pose import Pose
from composer.sources.source import ReadAs, Source
from composer.tree.read_row import ReadRow

IN_PLACE = Pose()
Tables: TypeAlias = Mapping[ReadAs, tuple[ReadRow, ...]]
"""What was read of sources that are not MJCF, and what was not."""


@dataclass(frozen=True, slots=True)
class PartRecord:
    """A source model, the prefix of its names (separator included), and the pose of its own world.

    `part` is its name in a recipe: the prefix without its last separator, `base` for the base, and both for a part
    of a part. `body` is the body that the part's world is fixed to, None for the world, with `pose` in the body's
    frame, or None if the pose is unknown. `keys` starts the names of its keys; None if they were left out. `welded`
    says that free joints at its root were removed, `stands` that it is fixed in the world, where the root link of a
    URDF is fused with the world. `changed` are the arrays of `mjModel` that the recipe changes in it on purpose,
    `replaced_keys` the keys that the recipe writes in place of the source's keys of these names. `obscure` says why
    it cannot be compared, if so, and `reduced` why it is compared only if a check requests it. `subtree` is the
    body that was taken from the source, if not all of it was.
    """

    part: str
    prefix: str
    source: Source
    body: str | None = None
    pose: Pose | None = IN_PLACE
    keys: str | None = ""
    welded: bool = False
    stands: bool = True
    changed: tuple[str, ...] = ()
    replaced_keys: tuple[str, ...] = ()
    obscure: str | None = None
    subtree: str | None = None
    reduced: str | None = None

    @property
    def called(self) -> str:
        """Its name in messages."""
        return self.prefix or self.part


def of_part(members: Iterable[PartRecord], part: str | None, separator: str) -> list[PartRecord]:
    """Return the members of a part: one, or all of a nested recipe; with None every one."""
    return [
        member
        for member in members
        if part is None or member.part == part or member.part.startswith(part + separator)
    ]
