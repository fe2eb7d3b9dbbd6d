"""Limit of a target in which an inertia needs a mass: inertias without mass are removed."""

from __future__ import annotations

from composer.targets.draft import Draft
from composer.targets.limit import Limit, Outcome


def _bare(draft: Draft) -> None:
    for inertial in list(draft.root.iterfind(".//inertial")):
        if float(str(inertial.get("mass"))) == 0:
            draft.remove(inertial)
    for compiler in draft.root.iterchildren("compiler"):
        compiler.attrib.pop("inertiafromgeom", "")  # their geoms are written without a mass


NO_EMPTY_INERTIA = Limit("massless", Outcome.KEPT, _bare)
