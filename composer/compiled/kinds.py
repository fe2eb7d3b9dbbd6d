"""Who is in a compiled model: the kinds of element `mjModel` holds, and the names of each kind's elements.

Everything is read from the arrays of the model object, so MuJoCo itself is never imported here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

Model: TypeAlias = Any
"""A compiled ``mujoco.MjModel``; untyped, because only ``composer.engine`` may import MuJoCo."""


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of element: the word used for it in messages, and how its arrays are called in `mjModel`."""

    word: str
    arrays: str

    @property
    def addresses(self) -> str:
        """The array of addresses of the names; its length is the number of elements, in every version."""
        return f"name_{self.arrays}adr"


KINDS: dict[str, Kind] = {
    word: Kind(word, arrays)
    for word, arrays in (
        ("body", "body"),
        ("joint", "jnt"),
        ("geom", "geom"),
        ("site", "site"),
        ("camera", "cam"),
        ("light", "light"),
        ("texture", "tex"),
        ("material", "mat"),
        ("mesh", "mesh"),
        ("hfield", "hfield"),
        ("skin", "skin"),
        ("flex", "flex"),
        ("tendon", "tendon"),
        ("equality", "eq"),
        ("pair", "pair"),
        ("exclude", "exclude"),
        ("actuator", "actuator"),
        ("sensor", "sensor"),
        ("numeric", "numeric"),
        ("text", "text"),
        ("tuple", "tuple"),
        ("plugin", "plugin"),
        ("key", "key"),
    )
}

OF_OBJECT_TYPE: dict[int, str] = {
    1: "body",
    2: "body",
    3: "joint",
    5: "geom",
    6: "site",
    7: "camera",
    8: "light",
    9: "flex",
    10: "mesh",
    11: "skin",
    12: "hfield",
    13: "texture",
    14: "material",
    15: "pair",
    16: "exclude",
    17: "equality",
    18: "tendon",
    19: "actuator",
    20: "sensor",
    21: "numeric",
    22: "text",
    23: "tuple",
    24: "key",
    25: "plugin",
}
"""The kind each value of `mjtObj` stands for; body and xbody are one kind."""

JOINT_POSITIONS = (7, 4, 1, 1)
"""How many entries of `qpos` a free, ball, slide and hinge joint takes, by `jnt_type`."""

JOINT_VELOCITIES = (6, 3, 1, 1)
"""How many degrees of freedom the same joints have."""

FREE_JOINT = 0


class NameTable:
    """The names of one model's elements, by kind and in the order of their ids; unnamed ones are ``""``."""

    def __init__(self, model: Model) -> None:
        text: bytes = model.names
        self.model = model
        self.names: dict[str, list[str]] = {}
        self.ids: dict[str, dict[str, int]] = {}
        for word, kind in KINDS.items():
            addresses = getattr(model, kind.addresses).tolist()
            names = [text[at : text.index(b"\0", at)].decode("utf-8", "replace") for at in addresses]
            self.names[word] = names
            self.ids[word] = {name: i for i, name in enumerate(names) if name}

    def count(self, kind: str) -> int:
        return len(self.names[kind])

    def describe(self, kind: str, index: int) -> str:
        """The element's name; for an unnamed one, where it stands: ``#2 of body `arm```, or ``#5``."""
        name = self.names[kind][index]
        if name:
            return name
        owner = {"joint": "jnt_bodyid", "geom": "geom_bodyid", "site": "site_bodyid", "camera": "cam_bodyid",
                 "light": "light_bodyid"}.get(kind)  # fmt: skip
        if owner is None:
            return f"#{index}"
        bodies = getattr(self.model, owner)
        body = int(bodies[index])
        place = int((bodies[:index] == body).sum())
        return f"#{place} of body `{self.describe('body', body)}`"
