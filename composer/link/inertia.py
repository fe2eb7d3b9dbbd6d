"""Pass: the mass of each body becomes explicit if the unit's rule for it is not MuJoCo's default.

The model always has `inertiafromgeom="auto"` and `inertiagrouprange="0 5"`, MuJoCo's defaults.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

from lxml.etree import _Element as Node

from composer.link import numbers
from composer.link.linking import Linking
from composer.link.measured_unit import BODIES, Survey, cannot_be_kept, survey
from composer.tree.classes import ORIENTATIONS, Classes, childclass_of, own, walk_bodies
from composer.tree.settings import Settings
from composer.tree.unit import Unit

_DEFAULT = Settings()
# Rules that change a whole model after its parts: only MuJoCo can say what they give.
# MuJoCo 4.0 gives an empty `<body/>` a mass of 3 under `boundmass="3"`, and makes moments of 1 1 5 three of 2.3333
# under `balanceinertia`; `settotalmass` scales all bodies when everything else is done.
MEASURED = ("balanceinertia", "boundmass", "boundinertia", "settotalmass")
_RULES = ("inertiafromgeom", "inertiagrouprange", *MEASURED)


def inertia(linking: Linking) -> None:
    """Rewrite each unit whose rule differs; a model of one unit keeps its own rules.

    A geom outside of `inertiagrouprange` gives its body no mass:

    >>> from composer.link.example import after
    >>> part = (
    ...     '<compiler inertiagrouprange="0 1"/>'
    ...     '<worldbody><body><geom size=".1" group="2"/></body></worldbody>'
    ... )
    >>> after(inertia, part)
    part: <worldbody><body><geom size=".1" group="2" mass="0"/></body></worldbody>
    """
    if not linking.composed:
        return
    for unit in linking.units:
        settings = unit.settings
        if any(getattr(settings, name) != getattr(_DEFAULT, name) for name in MEASURED):
            write_inertias(linking, unit)
            continue
        if settings.inertiagrouprange.split() != ["0", "5"]:
            _leave_out_groups(unit, *(int(bound) for bound in settings.inertiagrouprange.split()))
        if settings.inertiafromgeom == "true":
            _from_geoms(unit)
        elif settings.inertiafromgeom == "false":
            _never_from_geoms(linking, unit)


def _bodies(unit: Unit) -> list[Node]:
    return [element for element, _ in walk_bodies(unit.root) if element.tag == "body"]


def _leave_out_groups(unit: Unit, low: int, high: int) -> None:
    classes = unit.classes
    for element, childclass in walk_bodies(unit.root):
        if element.tag == "geom":
            group = int(classes.effective(element, childclass, "group") or 0)
            # The geom keeps its collisions and its looks: only a mass of 0 takes it out of the inertia. In MuJoCo 4.0
            # `inertiagrouprange="1 2"` leaves of two unit spheres in groups 0 and 1 the mass of one, 4188.79.
            if not low <= group <= high:
                element.set("mass", "0")


def _from_geoms(unit: Unit) -> None:
    """Apply the rule `true`: geoms override a written inertial; a body without geoms keeps it."""
    # A body whose geoms all have no mass counts as one without geoms: in MuJoCo 4.0 `<body><inertial mass="7" pos="0 0
    # 0" diaginertia="1 1 1"/></body>` keeps its mass of 7 under `inertiafromgeom="true"`.
    classes = unit.classes
    for body in _bodies(unit):
        inertials = own(body, "inertial")
        if inertials and any(has_mass(geom, classes) for geom in own(body, "geom")):
            for inertial in inertials:
                holder = inertial.getparent()
                assert holder is not None
                holder.remove(inertial)


def has_mass(geom: Node, classes: Classes) -> bool:
    childclass = childclass_of(geom)
    mass = classes.effective(geom, childclass, "mass")
    # A mass wins over a density: in MuJoCo 4.0 `<geom size=".1" mass="0" density="1000"/>` weighs nothing.
    if mass is not None:
        return numbers.read(mass)[0] != 0
    density = classes.effective(geom, childclass, "density")
    return density is None or numbers.read(density)[0] != 0


def _never_from_geoms(linking: Linking, unit: Unit) -> None:
    """Apply the rule `false`: a body without a written inertial has no mass, whatever its geoms are."""
    classes = unit.classes
    for body in _bodies(unit):
        if not own(body, "inertial"):
            for geom in own(body, "geom"):
                if has_mass(geom, classes):
                    geom.set("mass", "0")
            body.insert(0, body.makeelement("inertial", {**_pose(body), "mass": "0", "diaginertia": "0 0 0"}))
            linking.notes.inertia_written.add(body)


def _pose(body: Node) -> dict[str, str]:
    """Return the frame that MuJoCo uses for an inertia that is not set: the body's own pose, as written."""
    # MuJoCo 4.0 copies the frame of the body in its parent: with `<compiler inertiafromgeom="false"/>` the
    # `<body pos="1 2 3"><geom size=".1"/></body>` has `body_ipos` 1 2 3.
    written = {name: str(body.get(name)) for name in ("pos", *ORIENTATIONS) if body.get(name)}
    return {"pos": "0 0 0", **written}


def write_inertias(linking: Linking, unit: Unit) -> None:
    """Compile the unit alone, and write the inertia that MuJoCo computes for every body."""
    wanting = [name for name in MEASURED if getattr(unit.settings, name) != getattr(_DEFAULT, name)]
    found = survey(linking, unit, wanting, BODIES)
    if found is not None:
        write_measured(linking, unit, wanting, _bodies(unit), found)


def settle(linking: Linking, unit: Unit, changed: Collection[Node], found: Survey) -> None:
    """Write the surveyed inertia of the changed bodies, or of all bodies if a rule of the unit requires it.

    Afterwards the unit has MuJoCo's own rules, in the place of those that the survey has applied.
    """
    ruled = [
        name for name in _RULES if getattr(unit.settings, name).split() != getattr(_DEFAULT, name).split()
    ]
    bodies = [body for body in _bodies(unit) if (ruled or body in changed) and not found.is_gone(body)]
    if write_measured(linking, unit, ruled or ["fusestatic"], bodies, found):
        unit.forget_settings(*ruled)


def write_measured(
    linking: Linking, unit: Unit, settings: Sequence[str], bodies: Iterable[Node], found: Survey
) -> bool:
    """Write the surveyed inertia onto these bodies. Report a body for which that is impossible."""
    flexible = next(unit.root.iter("flexcomp"), None)
    if flexible is not None and any(name in settings for name in MEASURED):
        cannot_be_kept(linking, unit, settings, "`<flexcomp>` is expanded by MuJoCo")
        return False
    for body in bodies:
        rows = [found.values(body, array, width) for array, width in zip(BODIES, (1, 3, 4, 3), strict=True)]
        mass, pos, quat, moments = rows
        if mass is None or pos is None or quat is None or moments is None:
            gone = found.is_gone(body)
            why = "`fusestatic` makes this body one with another" if gone else "the copies of a body differ"
            cannot_be_kept(linking, unit, settings, why, body)
            return False
        written = own(body, "inertial")
        for inertial in written:
            holder = inertial.getparent()
            assert holder is not None
            holder.remove(inertial)
        if not written:
            linking.notes.inertia_written.add(body)
        # What has no mass and no geoms needs no inertial. Where there are geoms, the inertial takes their place, as it
        # does under `auto`: `<body><inertial mass="1" …/><geom size="1"/></body>` weighs 1 in MuJoCo 4.0.
        if any(mass) or any(moments) or written or own(body, "geom"):
            values = {"pos": pos, "quat": quat, "mass": mass, "diaginertia": moments}
            body.insert(
                0, body.makeelement("inertial", {name: numbers.text(given) for name, given in values.items()})
            )
    return True
