"""The keys of all units, split by joint, actuator and mocap body, and their layouts."""

from __future__ import annotations

from dataclasses import field

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.link.layout import Holder, Layout, Slot
from composer.link.part import Part
from composer.numerics.pose import Pose
from composer.tree.key import Key, PartKeys


@dataclass(eq=False, slots=True)
class Written:
    """A key that a recipe writes: the keys that it takes over, its entries by vector, and what is to hold the pose.

    With `forces`, the controls that hold also balance what acts on the model there. `void` is what edits have made
    meaningless before.
    """

    taken: tuple[Node, ...]
    void: frozenset[Node]
    forces: bool
    entries: dict[str, dict[Node, tuple[list[float], Span]]] = field(default_factory=dict)
    held: dict[Node, Span] = field(default_factory=dict)


@dataclass(eq=False, slots=True)
class KeyTable:
    """The keys of the units and their layouts.

    Where keys come from: `own` holds those of the base (under None) and of each part. `by_part` holds those of
    every part by path, including the parts of parts, and those of the base under `base`. Until `part_keys.py`
    splits the keys, `own` is empty and `by_part` is None. `written` are the keys of the recipe, `replaced` the keys
    of parts that these replace, by name. `attached` are the models that MuJoCo attaches to parts and whose keys
    contain poses in the world.

    How they are laid out: `base_layout` is the layout of the base alone, `final_layout` that of the finished model;
    each part has its own. `measured` has the widths that only MuJoCo knows, `references` and `mocap_references` the
    reference configuration that only MuJoCo knows.

    How edits of the joined model affect keys: `edited` is set if there may be edits, `reshaped` are the elements
    whose number of values may have changed, `shapes` has what decided the vertices of each `<flexcomp>`, and
    `void_keys` are the elements whose values in keys have become meaningless. `edited_keys` are keys whose numbers
    edits or draws have changed, and `noted` is what the recipe writes into its own keys, by their elements.
    """

    own: dict[Part | None, tuple[Key, ...]] = field(default_factory=dict)
    by_part: dict[str, PartKeys] | None = None
    written: list[Key] = field(default_factory=list)
    replaced: dict[str, Key] = field(default_factory=dict)
    attached: list[tuple[Part, Node]] = field(default_factory=list)
    base_layout: Layout | None = None
    final_layout: Layout | None = None
    measured: dict[Node, Slot] = field(default_factory=dict)
    references: dict[Holder, list[str]] = field(default_factory=dict)
    mocap_references: dict[Holder, list[Pose]] = field(default_factory=dict)
    edited: bool = False
    reshaped: set[Node] = field(default_factory=set)
    shapes: dict[Node, str] = field(default_factory=dict)
    void_keys: set[Node] = field(default_factory=set)
    edited_keys: set[Node] = field(default_factory=set)
    noted: dict[Node, Written] = field(default_factory=dict)
