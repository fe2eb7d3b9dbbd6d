"""What composing finds out about a plan: what is left behind, and what edits select."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from typing import TYPE_CHECKING, TypeAlias

from composer.dataclass import dataclass
from composer.recipe.fault import Path
from composer.tree.adopted import Adopted

if TYPE_CHECKING:
    from composer.link.subtree import Left, Subtree
    from composer.plan.made_shapes import MadeShapes

Place: TypeAlias = tuple[str, Path]
"""A recipe's file, and a path in it."""


@dataclass(frozen=True, slots=True)
class EditOutcome:
    """The effect of an entry of `edit`: how many elements of each kind it selects, and what it removes.

    `gone` has what was selected first, then what goes with it; `made` what was made of meshes.
    """

    selected: Mapping[str, int]
    gone: tuple[Left, ...] = ()
    made: tuple[MadeShapes, ...] = ()


@dataclass(frozen=True, slots=True)
class Excluded:
    """Two bodies that need not collide, and why, in words; "" for bodies that touch."""

    one: str
    other: str
    why: str


@dataclass(frozen=True, slots=True)
class Gains:
    """The stiffness and the damping that a servo gives a joint or a tendon through its `gear`.

    `unit` is that of its force: N or N·m, or "" along a tendon.
    """

    actuator: str
    kp: float
    kv: float
    gear: float
    unit: str


@dataclass(frozen=True, slots=True)
class Foreseen:
    """What composing finds out about a plan.

    `adopted` are the settings that the model takes from its parts, `excluded` the bodies that need not collide, `gains`
    has the gains of the servos of a model whose actuators are edited, as their joints feel them.
    """

    subtrees: Mapping[Place, Subtree] = field(default_factory=dict)
    edits: Mapping[Place, EditOutcome] = field(default_factory=dict)
    adopted: tuple[Adopted, ...] = ()
    excluded: tuple[Excluded, ...] = ()
    gains: tuple[Gains, ...] = ()
