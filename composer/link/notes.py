"""What one pass of the linker finds out and a later one needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from lxml.etree import _Element as Node

from composer.diagnostics.span import Span
from composer.link.part import Part
from composer.tree.unit import Unit


class Floating(NamedTuple):
    """A body at the root of a part that is free by a `joint` or, with None, is a mocap body; what messages call it.

    `alone`: there is nothing else in the part's world.
    """

    part: Part
    body: Node
    joint: Node | None
    called: str
    alone: bool


class Flex(NamedTuple):
    """A `<flexcomp>` at the root of a unit, and the joint settings of the unit's top class that it takes."""

    element: Node
    unit: Unit
    part: Part | None
    joint: Mapping[str, str]


class MemoryRequest(NamedTuple):
    """How much memory a source asks for, by which attribute of `<size>`, and where; what messages call the source."""

    name: str
    value: str
    called: str
    span: Span


@dataclass(eq=False, slots=True)
class Notes:
    """`aligned`: the model says `alignfree`. `floating` and `planes` are what may not stand below a body that moves.

    `flexes` stand in the world of their units; `main_joint` are the joint settings that the model's top class keeps for
    them. `replicates` says which unit each `<replicate>` comes from. `inertia_written` are the bodies whose inertia has
    been written out, so that what is added to them adds no mass. `drawn` holds the values drawn for an element, by
    field. `memory` is what the sources ask for, if MuJoCo may have to give more.
    """

    aligned: bool = False
    floating: list[Floating] = field(default_factory=list)
    planes: list[tuple[Part, Node]] = field(default_factory=list)
    flexes: list[Flex] = field(default_factory=list)
    main_joint: dict[str, str] = field(default_factory=dict)
    replicates: list[tuple[Unit, Node]] = field(default_factory=list)
    inertia_written: set[Node] = field(default_factory=set)
    drawn: dict[Node, dict[str, object]] = field(default_factory=dict)
    memory: tuple[MemoryRequest, ...] = ()
