"""The section `interface`: the names of joints, actuators, sensors and keys, in the order that programs rely on."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar

from pydantic import Discriminator, Tag

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Path
from mjcompose.language.forms.model import IT, Model
from mjcompose.language.forms.scalars import Checked, Expects, Items, Name, When

MORE = ("…", "...")
"""The last entry of a list that does not name everything."""
KINDS = ("joint", "actuator", "sensor", "key")


class Entry(Model):
    """One name, and the builds that have it."""

    example: ClassVar = "{name: NAME, when: {…}}"

    name: Annotated[str, Name(*KINDS)]
    """the name in the built model, or `…` as the last entry for more names"""
    when: When = None


def _name(entry: Any) -> str:
    return entry if isinstance(entry, str) else str(entry.name)


def _fault(entries: tuple[Any, ...]) -> Fault | None:
    names = [*map(_name, entries)]
    for index, name in enumerate(names):
        if name in MORE and index < len(names) - 1:
            message = f"`{name}` in {IT} is not the last entry"
            return Fault("out-of-range", message, (index,), help="write `…` at the end, for all other names")
        if name in names[:index]:
            return Fault("name-clash", f"`{name}` is in {IT} twice", (index,), help="remove one of them")
    return None


def _form_of(entry: Any) -> str:
    return "<mapping>" if isinstance(entry, dict | list | Entry) else "<word>"


_Entry = Annotated[Entry, Tag("<mapping>")]
_Joint = Annotated[Annotated[str, Name("joint"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_Actuator = Annotated[Annotated[str, Name("actuator"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_Sensor = Annotated[Annotated[str, Name("sensor"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_Key = Annotated[Annotated[str, Name("key"), Tag("<word>")] | _Entry, Discriminator(_form_of)]
_EXPECTS = Expects("a list of names", "[lift, grip]")


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

    joint: Annotated[tuple[_Joint, ...], Items(), Checked(_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: joints, as in `qpos`."""
    actuator: Annotated[tuple[_Actuator, ...], Items(), Checked(_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: actuators, as in `ctrl`."""
    sensor: Annotated[tuple[_Sensor, ...], Items(), Checked(_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: sensors, as in `sensordata`."""
    key: Annotated[tuple[_Key, ...], Items(), Checked(_fault), _EXPECTS] | None = None
    """The names in their order, and `…` at the end if there are more: keys."""

    @property
    def orders(self) -> tuple[Order, ...]:
        """The lists that the recipe writes."""
        found: list[Order] = []
        for kind in KINDS:
            entries: tuple[Any, ...] | None = getattr(self, kind)
            if entries is not None:
                names = tuple(name for name in map(_name, entries) if name not in MORE)
                at = (*(self.at or ("interface",)), kind)
                found.append(Order(kind, names, more=len(names) < len(entries), at=at))
        return tuple(found)
