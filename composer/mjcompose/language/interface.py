"""The section `interface`: the names of joints, actuators, sensors and keys, in the order that programs rely on."""

from __future__ import annotations

from typing import Annotated, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import Checked, Expects, Items, Name, When

MORE = ("…", "...")
"""The last entry of a list that does not name everything."""
KINDS = ("joint", "actuator", "sensor", "key")


class Entry(Model):
    """One name, and the builds that have it."""

    short: ClassVar = "name"
    example: ClassVar = "{name: NAME, when: {…}}"

    name: Annotated[str, Name(*KINDS)]
    """the name in the built model, or `…` as the last entry for more names"""
    when: When = None


def _fault(entries: tuple[Entry, ...]) -> Fault | None:
    names = [each.name for each in entries]
    for index, name in enumerate(names):
        if name in MORE and index < len(names) - 1:
            message = f"`{name}` in {IT} is not the last entry"
            return Fault("out-of-range", message, (index,), help="write `…` at the end, for all other names")
        if name in names[:index]:
            return Fault("name-clash", f"`{name}` is in {IT} twice", (index,), help="remove one of them")
    return None


_Names = Annotated[tuple[Entry, ...], Items(), Checked(_fault), Expects("a list of names", "[lift, grip]")]


@dataclass(frozen=True, slots=True)
class Order:
    """The names of one kind in their order; `more` if others may follow. `at` is the path of the list."""

    kind: str
    names: tuple[str, ...]
    more: bool
    at: Path


class Interface(Model):
    """Names in the order that programs rely on, such as a trained policy."""

    depth: ClassVar = 3
    example: ClassVar = "{actuator: [NAME, NAME]}"

    joint: _Names | None = None
    """The names in their order, and `…` at the end if there are more: joints, as in `qpos`."""
    actuator: _Names | None = None
    """The names in their order, and `…` at the end if there are more: actuators, as in `ctrl`."""
    sensor: _Names | None = None
    """The names in their order, and `…` at the end if there are more: sensors, as in `sensordata`."""
    key: _Names | None = None
    """The names in their order, and `…` at the end if there are more: keys."""

    @property
    def orders(self) -> tuple[Order, ...]:
        """The lists that the recipe writes."""
        found: list[Order] = []
        for kind in KINDS:
            entries: tuple[Entry, ...] | None = getattr(self, kind)
            if entries is not None:
                names = tuple(each.name for each in entries if each.name not in MORE)
                at = (*(self.at or ("interface",)), kind)
                found.append(Order(kind, names, more=len(names) < len(entries), at=at))
        return tuple(found)
