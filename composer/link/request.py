"""What the caller asks of the linker. No pass changes it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Policy = Literal["error", "warning", "merge"]
KeyPolicy = Literal["merge", "prefix", "none"]


@dataclass(frozen=True, slots=True)
class Request:
    """How the parts are to be joined, and what the recipe will do to the model afterwards.

    `separator` stands between a prefix and a name. `conflict` says what happens where two units disagree about an
    option, and `overridden_options` holds the option paths (`option/cone`) that the recipe sets itself: they cannot
    conflict. `base_keyframes` says what happens to the keys of the base. `requested_keys` holds the paths of the parts
    whose keys the recipe uses in keys of its own; it is None if the recipe writes no key.

    The rest is what the recipe adds once the parts are joined. `isolated_tags` are the tags for which it sets the top
    default class of the base, which must not reach the parts. `adds_mass` says that it adds elements that the base's
    rules for a whole model (`settotalmass`) would reach.
    """

    separator: str = "/"
    conflict: Policy = "error"
    overridden_options: frozenset[str] = frozenset()
    base_keyframes: KeyPolicy = "merge"
    requested_keys: frozenset[str] | None = None
    isolated_tags: frozenset[str] = frozenset()
    adds_mass: bool = False
