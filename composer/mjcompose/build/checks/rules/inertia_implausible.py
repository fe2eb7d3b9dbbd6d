"""Rule `inertia-implausible`: masses and inertias fit the shapes of the bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from mjcompose.base.diagnostic import Fault
from mjcompose.build.checks.check import Scope
from mjcompose.build.checks.rules.rule import Rule, chosen, excepted, listed
from mjcompose.language.forms.scalars import Expects, Items, Name, NotNegative, Positive, Range, Unit
from mjcompose.mujoco.solids import Shapes, faults


class InertiaImplausible(Rule):
    """The geoms of a body could have its mass and inertia."""

    word: ClassVar = "inertia-implausible"
    kinds: ClassVar = ("body",)
    instead: ClassVar = {"bodies": "body"}

    body: Annotated[tuple[Annotated[str, Name("body", glob=True)], ...], Items(1, single=True)] = ()
    """the bodies; by default all with a mass and geoms"""
    density: Annotated[Range, Expects("a list of 2 numbers", "[100, 9000]"), Unit("kg/m³")] | None = None
    """the smallest and largest density, in kg/m³; by default any"""
    gyration: Positive = 1.0
    """the largest radius of gyration, relative to the distance of the farthest point from the center of mass"""
    outside: NotNegative = 0.02
    """the allowed distance of the center of mass outside the box around the geoms, relative to the box's diagonal"""


RULE = InertiaImplausible


def check(scope: Scope, settings: Mapping[str, Any]) -> list[Fault]:
    """Report masses or inertias that do not fit the bodies."""
    bodies = chosen(scope, "body", settings)
    if isinstance(bodies, Fault):
        return [bodies]
    ignored = excepted(scope, ("body",), settings)
    if isinstance(ignored, Fault):
        return [ignored]
    shapes = Shapes(scope.mujoco, scope.model)
    count, wrong = 0, []
    for body in list(scope.own("body")) if bodies is None else bodies:
        if body == 0 or ("body", body) in ignored or scope.model.body_mass[body] <= 0:
            continue
        if not shapes.of(body):
            continue
        count += 1
        name = scope.called("body", body)
        wrong += [f"{name}: {each}" for each in _faults(scope, shapes, body, settings=settings)]
    scope.found("bodies", count)
    scope.found("implausible", len(wrong))
    actual = f"{len(wrong)} fault{'s' * (len(wrong) > 1)} in {count} bodies"
    return listed(wrong, "masses and inertias that the geoms could have", actual)


def _faults(scope: Scope, shapes: Shapes, body: int, settings: Mapping[str, Any]) -> Iterator[str]:
    yield from faults(shapes, body, gyration=settings["gyration"], outside=settings["outside"])
    if settings["density"] is not None and (own := shapes.own(body)):
        mass, found, (low, high) = float(scope.model.body_mass[body]), shapes.volume(own), settings["density"]
        weighs = f"it weighs {mass:.4g} kg, which is {{:.4g}} kg/m³ of the volume of its geoms, {{}}"
        if found.most > 0 and mass / found.most > high:
            yield weighs.format(mass / found.most, f"above {high:g}")
        elif found.least > 0 and mass / found.least < low:
            yield weighs.format(mass / found.least, f"below {low:g}")
