"""The caller's request to the linker. No pass changes it."""

from __future__ import annotations

from typing import Literal

from composer.dataclass import dataclass

Policy = Literal["error", "warning", "merge"]
KeyPolicy = Literal["merge", "prefix", "none"]


@dataclass(frozen=True, slots=True)
class Request:
    """How to join the parts, and what the recipe will do to the model afterwards.

    `separator` goes between a prefix and a name. `conflict` is the policy for options on which two units disagree,
    and `overridden_options` holds the option paths (`option/cone`) that the recipe sets itself: they cannot
    conflict. `base_keyframes` is the policy for the keys of the base. `requested_keys` holds the paths of the parts
    whose keys the recipe uses in keys of its own; it is None if the recipe writes no key.

    The other fields describe what the recipe adds once the parts are joined. `isolated_tags` are the tags for which
    it sets the top default class of the base; these defaults must not reach the parts. `adds_mass` is set if it
    adds elements that the base's rules for a whole model (`settotalmass`) would reach.
    """

    separator: str = "/"
    conflict: Policy = "error"
    overridden_options: frozenset[str] = frozenset()
    base_keyframes: KeyPolicy = "merge"
    requested_keys: frozenset[str] | None = None
    isolated_tags: frozenset[str] = frozenset()
    adds_mass: bool = False
