"""What a child process that runs MuJoCo may use up."""

from __future__ import annotations

from dataclasses import dataclass

GIB = 1 << 30


@dataclass(frozen=True, slots=True)
class Limits:
    """Limits of one request.

    `seconds` is wall-clock time per request, without the start of Python and the import of MuJoCo.
    `memory` is in bytes and holds on POSIX only; elsewhere a model may take what the machine has.
    """

    seconds: float = 300.0
    memory: int = 8 * GIB

    def __post_init__(self) -> None:
        if not self.seconds > 0 or not self.memory > 0:
            raise ValueError("limits must be greater than zero")
