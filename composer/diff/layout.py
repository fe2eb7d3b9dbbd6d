"""Compare the sizes of the vectors of two models, and the addresses of elements in them."""

from __future__ import annotations

from collections.abc import Iterator

from composer.compiled.addresses import VECTORS, span
from composer.compiled.correspondence import Correspondence
from composer.compiled.kinds import KINDS, Model
from composer.diff.change import Count, Move
from composer.diff.values import close

_SIZES = ("nq", "nv", "nu", "na", "nmocap", "nsensordata")
_KINDS = ("joint", "actuator", "sensor", "body")


def counts(a: Model, b: Model, tolerance: float) -> Iterator[Count]:
    """Yield changes of vector sizes, of the numbers of elements, and of the total mass."""
    for name in _SIZES:
        if getattr(a, name) != getattr(b, name):
            yield Count(name, int(getattr(a, name)), int(getattr(b, name)))
    for kind, known in KINDS.items():
        before, after = (len(getattr(model, known.addresses)) for model in (a, b))
        if before != after:
            yield Count(kind, before, after)
    mass = float(a.body_mass.sum()), float(b.body_mass.sum())
    if not close(*mass, max(tolerance, 1e-12)):
        yield Count("total mass", *mass, "kg")


def moves(matching: Correspondence) -> Iterator[Move]:
    """Yield joints, actuators, sensors and mocap bodies of both models whose address in a vector changed."""
    a, b = matching.alone.model, matching.composed.model
    for kind in _KINDS:
        pairs = sorted(matching.pairs(kind), key=lambda pair: pair[1])
        for vector, (of, _) in VECTORS.items():
            for index, target in pairs if of == kind else ():
                before, after = span(a, vector, index), span(b, vector, target)
                if before and after and before.start != after.start:
                    name = matching.composed.describe(kind, target)
                    yield Move(vector, kind, name, before=before.start, after=after.start)
