"""One source model in a composition: what the comparison of the composition with it needs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from composer.numerics.pose import Pose
from composer.sources.source import Source

IN_PLACE = Pose()


@dataclass(frozen=True, slots=True)
class PartRecord:
    """A source model, the prefix of its names (separator included), and where its own world stands.

    `part` is what a recipe calls it: the prefix without its last separator, `base` for the base, and both for
    a part of a part. `body` is the body that the part's world is fixed to, None for the world, with `pose` in
    the body's frame, None where it is not known. `keys` stands before the names of its keys; None where they
    were left out. `welded` is whether free joints at its root were taken away, `stands` whether it is fixed in
    the world, where the root link of URDF becomes one with it. `changed` are the arrays of
    `mjModel` that the recipe changes in it on purpose, `replaced_keys` the keys of the composition that the recipe
    writes itself, in place of the source's keys of those names. `obscure` says why it cannot be compared, if so, and
    `reduced` why it is compared only where a check asks for it. Of a source of which one body was taken, `subtree` is
    that body.
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
        """What messages call it."""
        return self.prefix or self.part


def of_part(members: Iterable[PartRecord], part: str | None, separator: str) -> list[PartRecord]:
    """The members that a part has: one, or all of a nested recipe; with None every one."""
    return [
        member
        for member in members
        if part is None or member.part == part or member.part.startswith(part + separator)
    ]
