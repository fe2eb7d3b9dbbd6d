"""What a target cannot express, and what happens to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from composer.targets.draft import Draft


class Outcome(StrEnum):
    """What happens to a feature."""

    KEPT = "written"
    WRITTEN = "written otherwise"
    PARTLY = "partly"
    LEFT_OUT = "left out"
    SOME_REFUSED = "some refused"
    REFUSED = "refused"


@dataclass(frozen=True, slots=True)
class Limit:
    """A feature that a target does not support. `apply` changes the draft and records what is lost."""

    feature: str
    outcome: Outcome
    apply: Callable[[Draft], None]
