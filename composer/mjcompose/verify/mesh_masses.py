"""Warn about parts that are meshes and weigh more than a ton: most often their files are in millimeters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from lxml.etree import _Element as Node

from mjcompose.base.diagnostic import Note
from mjcompose.base.sink import Sink
from mjcompose.mujoco import engine
from mjcompose.mujoco.shapes import SIZE
from mjcompose.plan.plan import PlacedModel, Plan
from mjcompose.sources.reference import Source
from mjcompose.text.node import locate
from mjcompose.tree.classes import given
from mjcompose.tree.select import kind_of
from mjcompose.tree.unit import Unit
from mjcompose.verify.compile import WHOLE

if TYPE_CHECKING:
    from mjcompose.mujoco.model_types import MjModel

_HEAVY = 1000.0
"""In kg. Water has a density of 1000 kg/m³, the density that MuJoCo takes, so this is a cubic meter."""


def check_mesh_masses(plan: Plan, model: Unit, session: engine.Session, sink: Sink) -> None:
    """Warn about mesh parts whose mass follows from MuJoCo's density and is more than a ton; once for all copies."""
    parts = [place for place in plan.walk() if isinstance(place.model, Source) and place.model.format == "mesh"]
    if not parts:
        return
    geoms = {str(geom.get("name")): geom for geom in model.root.iterfind("worldbody//geom[@name]")}
    bodies: dict[str, PlacedModel] = {}
    for place in parts:
        assert isinstance(place.model, Source)
        geom = geoms.get(place.prefix + place.model.path.stem)
        if geom is not None and (body := _body_weighed_by(geom, model)) is not None:
            bodies[body] = place
    answer = engine.call(session, masses, [WHOLE], argument=list(bodies))
    if not answer.ok:
        sink.error("mujoco-crash", f"MuJoCo fails on the masses of the parts: {answer.error}", plan.span)
        return
    warned = set()
    for place, mass in zip(bodies.values(), answer.value, strict=True):
        assert place.step is not None and place.outer is not None and isinstance(place.model, Source)
        span = locate(place.outer.document, (*place.step.at, "model"))
        if mass is None or mass <= _HEAVY or span in warned:
            continue
        warned.add(span)
        file = place.model.path.name
        mesh = place.model.path.stem
        scale = f"edit: [{{select: {{mesh: {mesh}}}, set: {{scale: [0.001, 0.001, 0.001]}}}}]"
        sink.warning(
            SIZE,
            f"`{file}` weighs {mass:.3g} kg, with the density of water that MuJoCo takes",
            span,
            notes=(Note(f"or give it its mass: `{{select: {{geom: {mesh}}}, set: {{mass: 0.3}}}}`"),),
            help=f"if the file is in millimeters, write `{scale}` in the part",
        )


def _body_weighed_by(geom: Node, model: Unit) -> str | None:
    """Return the body whose mass follows from the density of a geom; None if the recipe gives a mass or a density."""
    body = next(geom.iterancestors("body"), None)
    if body is None or body.find("inertial") is not None:
        return None
    by_class = {attribute.name for attribute, _ in given(geom, kind_of(geom), model.classes)}
    if {"mass", "density"} & {*geom.keys(), *by_class}:
        return None
    return str(body.get("name") or "") or None


def masses(_mujoco: object, model: MjModel, bodies: Sequence[str]) -> list[float | None]:
    """Return the masses of bodies by name, None without a body; runs under `mjcompose.mujoco.engine.call`."""
    numbers = {model.body(number).name: number for number in range(model.nbody)}
    return [float(model.body_mass[numbers[body]]) if body in numbers else None for body in bodies]
