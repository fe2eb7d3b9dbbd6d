"""The loss of something that a target cannot express, and its words."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import StrEnum

from composer.dataclass import dataclass


class Outcome(StrEnum):
    """What happens to a feature."""

    KEPT = "written"
    WRITTEN = "written otherwise"
    PARTLY = "partly"
    LEFT_OUT = "left out"
    SOME_REFUSED = "some refused"
    REFUSED = "refused"


@dataclass(frozen=True, slots=True)
class Loss:
    """An element that a target cannot express, and what happens to it.

    `feature` is a row of the table of features. `kind` and `number` identify the element in the compiled model,
    `tag` and `name` are for messages. `what` names the part of the element that is left out; it is empty for the
    element itself. `why` is a remark, or, if the element is written otherwise or refused, the sentence about it.
    With one that is refused, no model is written.
    """

    feature: str
    kind: str
    number: int
    tag: str
    name: str
    why: str = ""
    what: str = ""
    outcome: str = Outcome.LEFT_OUT
    help: str | None = None

    @property
    def refused(self) -> bool:
        return self.outcome == Outcome.REFUSED

    @property
    def otherwise(self) -> bool:
        """Whether the target gets the same model, written in another way."""
        return self.outcome == Outcome.WRITTEN

    @property
    def shown(self) -> str:
        return f"{self.tag} `{self.name}`" if self.name else self.tag


_PLURALS = {
    "body": "bodies", "equality": "equality constraints", "key": "keyframes", "flex": "flexes", "pair": "contact pairs",
    "exclude": "excluded contacts", "mesh": "meshes",
}  # fmt: skip
_SINGULARS = {
    "equality": "equality constraint",
    "key": "keyframe",
    "pair": "contact pair",
    "exclude": "excluded contact",
}
_NAMED = 3
_OPTION = "option"


def grouped(losses: Iterable[Loss]) -> Iterator[list[Loss]]:
    """Yield the losses of one kind together, in their order."""
    groups: dict[tuple[str, ...], list[Loss]] = {}
    for loss in losses:
        groups.setdefault(
            (loss.outcome, loss.feature, loss.what, loss.why, loss.kind or loss.tag), []
        ).append(loss)
    yield from groups.values()


def in_words(title: str, group: list[Loss]) -> str:
    """Return a sentence about losses of one kind: how many, and the first names.

    >>> in_words("Pinocchio", [Loss("damping", "joint", n, "joint", f"j{n}", what="damping") for n in range(5)])
    'Pinocchio ignores damping of 5 joints: `j0`, `j1`, `j2` and 2 more'
    """
    first = group[0]
    counted = _counted(group)
    if first.otherwise:
        return f"{title} gets {counted} in another form: {first.why}"
    if first.refused:
        return f"{counted}: {first.why}"
    of = f"{first.what} of " if first.what else ""
    if first.tag == _OPTION and first.what:
        counted, of = first.what, ""
    return f"{title} ignores {of}{counted}" + (f"; {first.why}" if first.why else "")


def _counted(group: list[Loss]) -> str:
    """Return the number of elements with their kind and the first of their names."""
    first = group[0]
    kind = first.kind or first.tag
    if kind == _OPTION:
        return _OPTION
    word = _SINGULARS.get(kind, kind) if len(group) == 1 else _PLURALS.get(kind, f"{kind}s")
    names = [f"`{each.name}`" for each in group if each.name]
    if not names:
        return f"{len(group)} {word}"
    shown = names if len(names) <= _NAMED + 1 else names[:_NAMED]
    more = len(names) - len(shown)
    listed = f"{', '.join(shown)} and {more} more" if more else ", ".join(shown)
    return f"{len(group)} {word}: {listed}"
