"""What composing finds out about a plan: what is left behind, and what edits select."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeAlias

from composer.recipe.fault import Path
from composer.tree.adopted import Adopted

if TYPE_CHECKING:
    from composer.link.subtree import Left, Subtree

Place: TypeAlias = tuple[str, Path]
"""A recipe's file, and a path in it."""


@dataclass(frozen=True, slots=True)
class EditOutcome:
    """The effect of an entry of `edit`: how many elements of each kind it selects, and what it removes.

    `gone` lists the selected elements first, then those that are removed with them.
    """

    selected: Mapping[str, int]
    gone: tuple[Left, ...] = ()


@dataclass(frozen=True, slots=True)
class Foreseen:
    """What composing finds out about a plan.

    `subtrees` has the models that are taken in part, `edits` the entries that were carried out. `adopted` are the
    settings that the model takes from its parts, `touching` the pairs of bodies whose contacts are excluded because
    they touch.
    """

    subtrees: Mapping[Place, Subtree] = field(default_factory=dict)
    edits: Mapping[Place, EditOutcome] = field(default_factory=dict)
    adopted: tuple[Adopted, ...] = ()
    touching: tuple[tuple[str, str], ...] = ()
