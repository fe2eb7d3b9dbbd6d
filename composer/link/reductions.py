"""Pass: `fusestatic` and `discardvisual`, by which MuJoCo leaves elements out: what it leaves out of a unit goes.

The unit is compiled alone, so that MuJoCo itself says which elements those are: its rules are not the same in every
version. The bodies that change get the inertia that they have there.
"""

from __future__ import annotations

from composer.link.discarding import discard
from composer.link.fusing import fuse, static_bodies
from composer.link.inertia import settle
from composer.link.linking import Linking
from composer.link.measured_unit import BODIES, NAMED, survey
from composer.link.part import Part
from composer.tree.unit import Unit

_REDUCING = ("fusestatic", "discardvisual")


def reductions(linking: Linking) -> None:
    """Reduce each unit that asks for it; a model of one unit leaves it to MuJoCo."""
    if not linking.composed:
        return
    _reduce(linking, linking.base, None)
    for part in linking.parts:
        _reduce(linking, part.unit, part)


def _reduce(linking: Linking, unit: Unit, part: Part | None) -> None:
    wanted = [name for name in _REDUCING if getattr(unit.settings, name) == "true"]
    if not wanted:
        return
    # On a joint of the recipe stands what would be part of a world alone: it keeps its mass.
    pinned = static_bodies(unit) if part is not None and (part.joints or part.mocap) else ()
    found = survey(linking, unit, wanted, (*BODIES, *NAMED), pinned=pinned)
    if found is None:
        return
    changed = discard(unit, found) if "discardvisual" in wanted else set()
    changed |= fuse(linking, unit, part, found) if "fusestatic" in wanted else set()
    unit.forget_settings(*wanted)
    settle(linking, unit, changed, found)
