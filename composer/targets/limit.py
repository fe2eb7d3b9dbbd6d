"""What a target cannot express, and what happens to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from composer.dataclass import dataclass
from composer.targets.draft import Draft
from composer.targets.loss import Outcome

__all__ = ["Limit", "Outcome", "Refusal", "Refuses"]


@dataclass(frozen=True, slots=True)
class Refusal:
    """An element of a compiled model that a simulator does not take; of its options the kind is `option`."""

    kind: str
    number: int
    why: str
    help: str


Refuses = Callable[[Any, Any], Iterator[Refusal]]
"""Of MuJoCo and a compiled model: what a simulator refuses of it."""


@dataclass(frozen=True, slots=True)
class Limit:
    """A feature that a target does not support. `apply` changes the draft and records what is lost.

    `refuses` judges the compiled model alone, for simulators that take MuJoCo's own `mjModel`.
    """

    feature: str
    outcome: Outcome
    apply: Callable[[Draft], None]
    refuses: Refuses | None = None
