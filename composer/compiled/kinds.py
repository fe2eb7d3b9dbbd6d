"""The kinds of element in `mjModel`, and the names of each kind's elements.

Everything is read from the arrays of the model object, so MuJoCo itself is never imported here.
"""

from __future__ import annotations

from typing import Any, TypeAlias

from composer.dataclass import dataclass

Model: TypeAlias = Any
"""A compiled ``mujoco.MjModel``; untyped, because only ``composer.engine`` may import MuJoCo."""


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of element: its word in messages, the prefix of its arrays, and its value of `mjtObj`."""

    word: str
    arrays: str
    object_type: int

    @property
    def addresses(self) -> str:
        """The array with the addresses of the names; its length is the number of elements in every version."""
        return f"name_{self.arrays}adr"

    @property
    def size(self) -> str:
        """The size of `mjModel` for the number of elements; MuJoCo 3 has no `nactuator`, which would equal `nu`."""
        return f"n{self.arrays}"


KINDS: dict[str, Kind] = {
    word: Kind(word, arrays, object_type)
    for word, arrays, object_type in (
        ("body", "body", 1),
        ("joint", "jnt", 3),
        ("geom", "geom", 5),
        ("site", "site", 6),
        ("camera", "cam", 7),
        ("light", "light", 8),
        ("texture", "tex", 13),
        ("material", "mat", 14),
        ("mesh", "mesh", 10),
        ("hfield", "hfield", 12),
        ("skin", "skin", 11),
        ("flex", "flex", 9),
        ("tendon", "tendon", 18),
        ("equality", "eq", 17),
        ("pair", "pair", 15),
        ("exclude", "exclude", 16),
        ("actuator", "actuator", 19),
        ("sensor", "sensor", 20),
        ("numeric", "numeric", 21),
        ("text", "text", 22),
        ("tuple", "tuple", 23),
        ("plugin", "plugin", 25),
        ("key", "key", 24),
    )
}
"""Every kind of element that `mjModel` names, in the order in which models are compared."""

_XBODY = 2
OF_OBJECT_TYPE: dict[int, str] = {_XBODY: "body", **{kind.object_type: word for word, kind in KINDS.items()}}
"""The kind for each value of `mjtObj`; body and xbody are one kind."""

ON_BODIES: dict[str, str] = {
    kind: f"{KINDS[kind].arrays}_bodyid" for kind in ("joint", "geom", "site", "camera", "light")
}
"""The kinds of elements on bodies, and the arrays with their bodies."""

HOLDERS: dict[str, str] = {"body": "body_parentid", **ON_BODIES}
"""The same with bodies themselves, which are on their parents."""


def holder(model: Model, kind: str, index: int) -> int:
    """Return the body of an element of one of the `HOLDERS`; for the world it is the world."""
    return int(getattr(model, HOLDERS[kind])[index])


def names(model: Model, kind: str) -> list[str]:
    """Return the names of a kind's elements by id, `""` for unnamed ones; bytes that are not UTF-8 are replaced."""
    text: bytes = model.names
    starts = [int(start) for start in getattr(model, KINDS[kind].addresses)]
    return [text[start : text.index(b"\0", start)].decode("utf-8", "replace") for start in starts]


class NameTable:
    """The names of a model's elements, by kind and in the order of their ids; unnamed ones are ``""``."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.names: dict[str, list[str]] = {}
        self.ids: dict[str, dict[str, int]] = {}
        for kind in KINDS:
            self.names[kind] = names(model, kind)
            self.ids[kind] = {name: i for i, name in enumerate(self.names[kind]) if name}

    def count(self, kind: str) -> int:
        return len(self.names[kind])

    def describe(self, kind: str, index: int) -> str:
        """Return the element's name, or the place of an unnamed one: ``#2 of body `arm```, or ``#5``."""
        name = self.names[kind][index]
        if name:
            return name
        if kind not in ON_BODIES:
            return f"#{index}"
        bodies = getattr(self.model, ON_BODIES[kind])
        body = int(bodies[index])
        place = int((bodies[:index] == body).sum())
        return f"#{place} of body `{self.describe('body', body)}`"
