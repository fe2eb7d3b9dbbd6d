"""Findings of one pass of the linker that a later pass needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.dataclass import dataclass
from composer.diagnostics.span import Span
from composer.link.part import Part
from composer.tree.unit import Unit


class Floating(NamedTuple):
    """A body at the root of a part that moves freely: by its free `joint` or, if that is None, as a mocap body.

    `called` is its name in messages. `alone` is set if the part's world contains nothing else.
    """

    part: Part
    body: Node
    joint: Node | None
    called: str
    alone: bool


class Flex(NamedTuple):
    """A `<flexcomp>` at the root of a unit, and the joint settings that it takes from the unit's top class."""

    element: Node
    unit: Unit
    part: Part | None
    joint: Mapping[str, str]


class MemoryRequest(NamedTuple):
    """The memory that a source requests by an attribute of `<size>`; `called` is the source's name in messages."""

    name: str
    value: str
    called: str
    span: Span


@dataclass(eq=False, slots=True)
class Notes:
    """The findings of the passes so far.

    `aligned`: the model has `alignfree`. `floating` and `planes` must not end up below a body that moves. `flexes`
    are in the world of their units; `main_joint` are the joint settings that the model's top class keeps for them.
    `replicates` has the unit of each `<replicate>`, `copied` the element that each one of a written-out replicate is a
    copy of, and the number of the copy. `inertia_written` are the bodies whose inertia is explicit, so
    that elements added to them add no mass. `drawn` holds the values drawn for an element, by field. `memory` are
    the requests of the sources, if MuJoCo may need more memory. `attached` are the models that MuJoCo attaches, by
    their `<model>`. `nameless` are bodies whose name is only for the linker.
    """

    aligned: bool = False
    floating: list[Floating] = field(default_factory=list)
    planes: list[tuple[Part, Node]] = field(default_factory=list)
    flexes: list[Flex] = field(default_factory=list)
    main_joint: dict[str, str] = field(default_factory=dict)
    replicates: list[tuple[Unit, Node]] = field(default_factory=list)
    copied: dict[Node, tuple[Node, tuple[Node, int]]] = field(default_factory=dict)
    inertia_written: set[Node] = field(default_factory=set)
    drawn: dict[Node, dict[str, object]] = field(default_factory=dict)
    memory: tuple[MemoryRequest, ...] = ()
    attached: dict[Node, Node] = field(default_factory=dict)
    nameless: set[Node] = field(default_factory=set)
