"""Limits for a child process that runs MuJoCo."""

from __future__ import annotations

from dataclasses import field

from composer.dataclass import dataclass
from composer.limits import in_force


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one request; the defaults are those in force.

    `seconds` is wall-clock time per request, without the start of Python and the import of MuJoCo. `memory` is in
    bytes and applies on POSIX only.
    """

    seconds: float = field(default_factory=lambda: in_force().time)
    memory: int = field(default_factory=lambda: in_force().memory)

    @property
    def step(self) -> float:
        """Seconds that the first step of a model may compute (POSIX).

        A slower model cannot be simulated in practice.
        """
        return self.seconds / 20

    def __post_init__(self) -> None:
        if not self.seconds > 0 or not self.memory > 0:
            raise ValueError("limits must be greater than zero")
