"""Motors as in their data sheets, and the table of those that come with mjcompose."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault
from mjcompose.base.extensions import Table
from mjcompose.language.form import EXCLUSIVE, Form, Schema, Settings, kind_of, reference, unknown_key

_LIBRARY = Path(__file__).with_name("motors.yaml")
NUMBERS = {
    "effort": "the greatest torque at the output, in N·m",
    "rated": "the torque that it can hold, in N·m",
    "speed": "the speed of the output without load, in rad/s",
    "gear": "the reduction: how often the rotor turns for one turn of the output",
    "rotor_inertia": "the inertia of the rotor before the reduction, in kg·m²",
    "armature": "the inertia of rotor and gears at the output, in kg·m²",
    "friction": "the dry friction at the output, in N·m",
    "damping": "the viscous friction at the output, in N·m·s/rad",
    "delay": "the time from a command to the torque, in seconds",
}
TEXTS = {
    "maker": "who makes it",
    "source": "where these numbers are from: a data sheet, with its address",
}
_NEEDED = ("effort", "source")
_MAY_BE_ZERO = ("friction", "damping", "delay")


@dataclass(frozen=True, slots=True)
class Motor:
    """A motor with its gears and controller. Everything but `rotor_inertia` is at the output. None means unknown."""

    effort: float
    source: str
    maker: str | None = None
    rated: float | None = None
    speed: float | None = None
    gear: float | None = None
    rotor_inertia: float | None = None
    armature: float | None = None
    friction: float | None = None
    damping: float | None = None
    delay: float | None = None

    @property
    def reflected(self) -> float | None:
        """Return the inertia at the output, in kg·m². That of the rotor counts with the square of the reduction.

        >>> Motor(12.0, "", gear=10, rotor_inertia=0.25).reflected
        25.0
        """
        if self.armature is not None or self.rotor_inertia is None:
            return self.armature
        return self.rotor_inertia * (self.gear or 1.0) ** 2


@dataclass(frozen=True, slots=True)
class Motors(Form):
    """Form of the field `motors`: a mapping from names to data sheets, read as a mapping from names to `Motor`."""

    def schema(self) -> Schema:
        numbers: dict[str, Schema] = {
            name: {**reference("number"), _bound(name): 0, "description": about}
            for name, about in NUMBERS.items()
        }
        texts: dict[str, Schema] = {
            name: {"type": "string", "minLength": 1, "description": about} for name, about in TEXTS.items()
        }
        sheet: Schema = {"type": "object", "properties": {**texts, **numbers}, "required": [*_NEEDED]}
        return {"type": "object", "additionalProperties": {**sheet, "additionalProperties": False}}

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Mapping[str, Motor]:
        if not isinstance(value, dict):
            message = f"`motors` expects a mapping from names to data sheets, got {kind_of(value)}"
            help = "write `motors: {NAME: {effort: 4.1, source: …}}`"
            faults.append(Fault("wrong-type", message, help=help))
            return {}
        read = {name: _motor(name, item, faults) for name, item in value.items()}
        return {name: motor for name, motor in read.items() if motor is not None}


def _motor(name: str, value: Any, faults: list[Fault]) -> Motor | None:
    if not isinstance(value, dict):
        message = f"motor `{name}` expects a mapping, got {kind_of(value)}"
        faults.append(
            Fault("wrong-type", message, (name,), help=f"write `{name}: {{effort: 4.1, source: …}}`")
        )
        return None
    before = len(faults)
    known = (*TEXTS, *NUMBERS)
    for key in value:
        if key not in known:
            faults.append(unknown_key(f"motor `{name}` has no key `{key}`", key, known, at=(name, key)))
    for key in _NEEDED:
        if key not in value:
            faults.append(
                Fault(
                    "missing-key", f"motor `{name}` lacks `{key}`: {({**NUMBERS, **TEXTS})[key]}", (name,), key=True,
                    help=f"write `{key}: {'4.1' if key in NUMBERS else 'the data sheet'}`", lacks=key,
                )
            )  # fmt: skip
    given = {key: each for key, each in value.items() if key in known}
    for key, each in given.items():
        fault = _text_fault(name, key, each) if key in TEXTS else _number_fault(name, key, each)
        faults += [fault] if fault is not None else []
    if "armature" in given and "rotor_inertia" in given:
        message = f"motor `{name}` has both `armature` and `rotor_inertia`"
        help = "leave one out: `armature` is the rotor's inertia times the square of `gear`"
        faults.append(Fault(EXCLUSIVE, message, (name, "rotor_inertia"), key=True, help=help))
    elif "rotor_inertia" in given and "gear" not in given:
        message = f"motor `{name}` has a `rotor_inertia`, and no `gear`"
        help = "write `gear: 1` where there is none"
        faults.append(Fault("missing-key", message, (name, "rotor_inertia"), key=True, help=help))
    return Motor(**given) if len(faults) == before else None


def _number_fault(name: str, key: str, value: Any) -> Fault | None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return Fault(
            "wrong-type", f"`{key}` of motor `{name}` expects a number, got {kind_of(value)}", (name, key)
        )
    least = "at least 0" if key in _MAY_BE_ZERO else "more than 0"
    if value < 0 or (value == 0 and key not in _MAY_BE_ZERO):
        return Fault(
            "out-of-range", f"`{key}` of motor `{name}` is {value:g}, and must be {least}", (name, key)
        )
    return None


def _text_fault(name: str, key: str, value: Any) -> Fault | None:
    if isinstance(value, str) and value:
        return None
    return Fault("wrong-type", f"`{key}` of motor `{name}` expects text, got {kind_of(value)}", (name, key))


def _bound(name: str) -> str:
    return "minimum" if name in _MAY_BE_ZERO else "exclusiveMinimum"


SHEETS: Table[Motor] = Table("datasheets", {}, "", kind=Motor)
"""The data sheets of other packages that recipes have named."""


@cache
def library() -> Mapping[str, Motor]:
    """Return the motors that come with mjcompose."""
    from mjcompose.base.sink import Sink  # few recipes name a motor
    from mjcompose.text.load import load
    from mjcompose.text.node import to_python

    sink, faults = Sink(), list[Fault]()
    node = load(_LIBRARY.read_bytes(), _LIBRARY.name, sink)
    found = Motors().read({} if node is None else to_python(node), faults, Settings())
    if sink.diagnostics or faults:
        told = [*(each.message for each in sink.diagnostics), *(each.message for each in faults)]
        raise ValueError(f"{_LIBRARY}: {told[0]}")
    return found


PAGE = Path(__file__).resolve().parents[3] / "docs" / "motors.md"
_TABLE = re.compile(r"(?<=<!-- motors -->\n).*?(?=<!-- end of motors -->)", re.DOTALL)
_ADDRESS = re.compile(r"https?://[^\s,]+[^\s,:]")


def table() -> str:
    """Return the table, with a row for each motor that comes with mjcompose."""
    lines = ["| motor | maker | torque, N·m | rated | speed, rad/s | inertia at the output, kg·m² | source |"]
    lines.append(f"|{'---|' * 7}")
    for name, motor in library().items():
        numbers = (motor.effort, motor.rated, motor.speed, motor.reflected)
        shown = ["" if each is None else f"{each:.4g}" for each in numbers]
        source = _ADDRESS.sub(lambda found: f"<{found.group()}>", motor.source)
        lines.append(f"| `{name}` | {motor.maker or ''} | {' | '.join(shown)} | {source} |")
    return "\n".join(lines) + "\n"


def with_table(page: str) -> str:
    """Return the text of the page with the current table."""
    return _TABLE.sub(lambda _: table(), page)


if __name__ == "__main__":
    PAGE.write_text(with_table(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
