"""Change the mass of a body: its whole inertia is scaled consistently, in whichever way it is given."""

from __future__ import annotations

import math
from collections.abc import Collection
from functools import cached_property

from lxml.etree import _Element as Node

from composer.compose.edit_values import Unusable
from composer.compose.editing import Editing
from composer.compose.without_keyframes import without_keys
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.sink import Sink
from composer.link import numbers
from composer.link.inertia import MEASURED, has_mass, write_inertias
from composer.link.linking import Linking
from composer.link.measured_unit import Survey, Unmeasurable, measured
from composer.recipe.fault import Path
from composer.tree.classes import childclass_of, own
from composer.tree.settings import Settings

_DENSITY = 1000.0
_DEFAULT = Settings()


class Masses:
    """The masses of the selected bodies; one call to MuJoCo measures those that the tree does not determine."""

    def __init__(self, editing: Editing, bodies: Collection[Node]) -> None:
        self.editing, self.bodies = editing, bodies

    def of(self, body: Node, at: Path) -> float:
        """Return the mass that MuJoCo computes for a body without its children, in kg."""
        inertial = self._inertial(body)
        if inertial is not None:
            return numbers.read(str(inertial.get("mass") or "0"))[0]
        own_masses = [self.editing.effective(geom, "mass") for geom in own(body, "geom")]
        if own_masses and all(mass is not None for mass in own_masses):
            return sum(numbers.read(str(mass))[0] for mass in own_masses)
        before = self.editing.sink.error_count
        found, hidden = self._survey
        if self.editing.sink.error_count > before:
            raise Unusable
        mass = None if found is None else found.values(body, "body_mass", 1)
        if mass is None:
            self.editing.sink.error(
                "selector",
                f"the mass of {self.editing.called(body)} is not known{hidden}",
                self.editing.span(at),
                notes=(Note("it is written here", self.editing.span_of(body)),),
                help="`scale` needs not know it; or write a `mass` on each of its geoms",
                subjects=self.editing.subjects(body),
            )
            raise Unusable
        return mass[0]

    def change(self, body: Node, verb: str, given: float, now: float | None, at: Path) -> None:
        """Multiply the mass and inertia of a body by the factor that follows from the verb and the number."""
        factor = given
        if verb != "scale":
            assert now is not None
            wanted = given if verb == "set" else now + given
            if now == 0:
                self._nothing(body, at)
            factor = wanted / now
        if factor < 0 or not math.isfinite(factor):
            self.editing.sink.error(
                "out-of-range",
                f"the mass of {self.editing.called(body)} would be negative",
                self.editing.span(at),
                subjects=self.editing.subjects(body),
            )
            raise Unusable
        self.settle()
        self._scale(body, factor, at)

    @cached_property
    def _survey(self) -> tuple[Survey | None, str]:
        """Return what MuJoCo computes for the model, or None and the reason why it gives no masses."""
        editing = self.editing
        unit = editing.linking.flat()
        aside = Sink()
        linking = Linking(unit, [], aside, measure=editing.linking.measure)
        with without_keys(unit.root):
            found = measured(linking, unit, ("body_mass",))
        if isinstance(found, Unmeasurable):
            return None, f": {found.why}"
        for each in aside.diagnostics:
            editing.sink.add(each)
        return found, ""

    def settle(self, *rules: str) -> None:
        """Rules that change a model after its bodies are written out as what they give, before a body is changed.

        Without `rules` those that change all bodies.
        """
        editing = self.editing
        unit = editing.linking.flat()
        if all(getattr(unit.settings, name) == getattr(_DEFAULT, name) for name in rules or MEASURED):
            return
        before = editing.sink.error_count
        with without_keys(unit.root):
            write_inertias(Linking(unit, [], editing.sink, measure=editing.linking.measure), unit)
        if editing.sink.error_count > before:
            raise Unusable
        editing.linking.base.forget_settings(*MEASURED, "inertiafromgeom", "inertiagrouprange")

    def _inertial(self, body: Node) -> Node | None:
        """Return the effective `<inertial>` of a body, or None."""
        inertials = own(body, "inertial")
        geoms = own(body, "geom")
        # With `inertiafromgeom="true"` an `<inertial>` holds only on bodies whose geoms have no mass: this weighs 2 kg.
        #   <body><inertial mass="9" pos="0 0 0" diaginertia="1 1 1"/><geom size="1" mass="2"/></body>
        if self.editing.linking.flat().settings.inertiafromgeom == "true" and any(
            has_mass(geom, self.editing.classes) for geom in geoms
        ):
            return None
        return inertials[-1] if inertials else None

    def _scale(self, body: Node, factor: float, at: Path) -> None:
        editing = self.editing
        inertial = self._inertial(body)
        if inertial is not None:
            # The moments follow the mass, as if the same body were of another material.
            for name in ("mass", "diaginertia", "fullinertia"):
                text = inertial.get(name)
                if text:
                    inertial.set(name, numbers.text(factor * each for each in numbers.read(str(text))))
            editing.write(inertial, dict.fromkeys(("mass", "diaginertia", "fullinertia"), at))
            return
        geoms = [geom for geom in own(body, "geom") if has_mass(geom, editing.classes)]
        if not geoms or editing.linking.flat().settings.inertiafromgeom == "false":
            self._nothing(body, at)
        for geom in geoms:
            mass = editing.classes.effective(geom, childclass_of(geom), "mass")
            # `mass="nan"` takes back the mass that a class gives: then the density counts.
            if mass is not None and not math.isnan(numbers.read(mass)[0]):
                name, value = "mass", numbers.read(mass)[0]
            else:
                density = editing.classes.effective(geom, childclass_of(geom), "density")
                name, value = "density", _DENSITY if density is None else numbers.read(density)[0]
            geom.set(name, numbers.text([factor * value]))
            editing.write(geom, {name: at})

    def _nothing(self, body: Node, at: Path) -> None:
        editing = self.editing
        editing.sink.error(
            "wrong-type",
            f"{editing.called(body)} has no mass of its own that could be scaled",
            editing.span(at, key=True),
            notes=(Note("it is written here", editing.span_of(body)),),
            help=self._instead(body),
            subjects=editing.subjects(body),
        )
        raise Unusable

    def _instead(self, body: Node) -> str:
        """Return advice for a body without mass, such as the body that the joint of a part adds."""
        name = body.get("name", "")
        if name.endswith(self.editing.linking.request.separator) and own(body, "body"):
            return f'`{name}` only carries the joint of the part; its bodies are `body: "{name}?**"`'
        return "set `mass` or `density` of a geom in it"
