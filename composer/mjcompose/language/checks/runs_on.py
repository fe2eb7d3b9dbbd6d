"""The check `runs_on`: simulators support everything in the model."""

from __future__ import annotations

from typing import ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import RUN_ON, Keys, Kind, Words


@dataclass(frozen=True, slots=True)
class RunsOn:
    """Nothing in the model is lost or refused when it is written for each of `simulators`."""

    word: ClassVar[str] = "runs_on"
    name: str
    simulators: tuple[str, ...]
    at: Path


class Simulators:
    """Form of the value of `runs_on`: a list of simulators."""

    words = Words(RUN_ON, "simulator")

    def read(self, keys: Keys) -> tuple[str, ...]:
        return self.words.read(keys, keys.value)

    def schema(self) -> dict[str, object]:
        about = (
            "Simulators have everything that the model has: nothing is left out where it is written for them."
        )
        return {**self.words.schema(), "description": about}


def make(keys: Keys, found: tuple[str, ...], at: Path) -> RunsOn:
    return RunsOn(keys.name, found, at)


KIND = Kind("runs_on", Simulators(), make, example="[mjx, warp]", of_target=True)
