"""One thing that became different between two versions of MuJoCo, and what a model needs for it to mean the same."""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum

from composer.dataclass import dataclass
from composer.migrate.editing import Editing

Act = Callable[[Editing], None]


class Sort(StrEnum):
    """What kind of change it is, and so what becomes of a model."""

    NAME = "another name"
    DEFAULT = "another default"
    MEANING = "another meaning"
    GONE = "taken away"
    ENGINE = "another result of the simulation"


@dataclass(frozen=True, slots=True)
class Change:
    """`version` is the first one that has what is new. `forward` makes a model of an earlier one mean the same in it,
    `backward` one of it mean the same in an earlier one. `of` is what it is about, `was` and `now` say it before and
    after, `becomes` what is written. `arrays` are those of `mjModel` in which it shows; without any it shows only in a
    simulation. `since` is the first version that had what was before.
    """

    name: str
    version: str
    sort: Sort
    of: str
    was: str
    now: str
    becomes: str
    forward: Act | None = None
    backward: Act | None = None
    arrays: tuple[str, ...] = ()
    since: str = "3.0.0"
