"""The keys of all units, cut by joint, actuator and mocap body, and what is known of how they are laid out."""

from __future__ import annotations

from dataclasses import dataclass, field

from lxml.etree import _Element as Node

from composer.link.layout import Layout, Slot
from composer.link.part import Part
from composer.numerics.pose import Pose
from composer.tree.key import Key, PartKeys


@dataclass(eq=False, slots=True)
class KeyTable:
    """Where keys come from: `own` are those of the base (under None) and of each part, `by_part` those of every part by
    path, parts of parts included, and the base under `base`; both are None or empty until `part_keys.py` cuts them.
    `written` are the keys of the recipe, `replaced` those of the parts, by name, whose place they take. `attached`
    are the models that MuJoCo attaches to parts and whose keys say where something is in the world.

    How they are laid out: `base_layout` in the base alone, `final_layout` in the finished model; each part has its own.
    `measured` has the widths that only MuJoCo knows, `references` and `mocap_references` the reference
    configuration that only MuJoCo knows.

    What edits of the joined model do to keys: `edited` says that there may be some, `reshaped` are the elements that
    may have more or fewer numbers now, `void_keys` those whose numbers have lost their meaning.
    """

    own: dict[Part | None, tuple[Key, ...]] = field(default_factory=dict)
    by_part: dict[str, PartKeys] | None = None
    written: list[Key] = field(default_factory=list)
    replaced: dict[str, Key] = field(default_factory=dict)
    attached: list[tuple[Part, Node]] = field(default_factory=list)
    base_layout: Layout | None = None
    final_layout: Layout | None = None
    measured: dict[Node, Slot] = field(default_factory=dict)
    references: dict[Node, list[str]] = field(default_factory=dict)
    mocap_references: dict[Node, list[Pose]] = field(default_factory=dict)
    edited: bool = False
    reshaped: set[Node] = field(default_factory=set)
    void_keys: set[Node] = field(default_factory=set)
