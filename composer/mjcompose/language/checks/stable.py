"""The check `stable`: a model comes to rest when it starts from a keyframe."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, ClassVar

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Path
from mjcompose.language.checks.form import Key, Keyed, Keys, Kind, Name, Number
from mjcompose.language.form import Schema, kind_of

SECONDS, MAX_SPEED = 1.0, 0.05


@dataclass(frozen=True, slots=True)
class Stable:
    """After `seconds` from `key`, no speed is above `max_speed` (m/s, rad/s).

    Without a key, the model starts from the reference configuration. With `within`, every joint must then be that
    close (m, rad) to its position in the key `near`, or in `key` itself.
    """

    word: ClassVar[str] = "stable"
    name: str
    key: str | None
    seconds: float
    max_speed: float
    at: Path
    near: str | None = None
    within: float | None = None


class Near:
    """Form of the keyframe to which the model stays near, and how near."""

    form = Keyed(
        "",
        Key("key", Name("the name of a keyframe"), "a keyframe; without it, the one where it starts"),
        Key(
            "within",
            Number(above=0),
            "how far a joint may be from where it is there, in m or rad",
            needed="0.05",
        ),
    )

    def read(self, keys: Keys, value: Any, *at: str | int) -> Mapping[str, Any]:
        if not isinstance(value, dict):
            key = f"key: {value}, " if isinstance(value, str) else ""
            message = f"`{at[-1]}` of {keys.owner} is a mapping, got {kind_of(value)}"
            keys.add("wrong-type", message, *at, help=f"write for instance `{at[-1]}: {{{key}within: 0.05}}`")
            return {}
        inner = Keys(keys.name, str(at[-1]), value, faults=[])
        found = self.form.read(inner)
        for fault in inner.faults:
            keys.faults.append(replace(fault, at=(keys.name, keys.word, *fault.at[1:])))
        return found

    def schema(self) -> Schema:
        return self.form.schema()


FORM = Keyed(
    "The model comes to rest: simulated from a keyframe, it does not diverge and stands still at the end.",
    Key("key", Name("the name of a keyframe"), "where it starts; without it, the reference configuration"),
    Key("seconds", Number(above=0), "how long it is simulated", default=SECONDS),
    Key(
        "max_speed",
        Number(above=0),
        "the greatest speed of a joint in the last tenth of that time, in m/s or rad/s",
        default=MAX_SPEED,
    ),
    Key("near", Near(), "that all joints are still near to where they are in a keyframe", default={}),
)


def make(keys: Keys, found: Mapping[str, Any], at: Path) -> Stable:
    near = found["near"]
    return Stable(
        keys.name,
        found["key"],
        found["seconds"],
        max_speed=found["max_speed"],
        at=at,
        near=near.get("key"),
        within=near.get("within"),
    )


KIND = Kind("stable", FORM, make, example="{key: home}")
