"""Values in an edit for one element, also a body's mass."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note, Path
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.link import numbers
from mjcompose.link.key_layout import joint_type
from mjcompose.model.classes import childclass_of, own
from mjcompose.model.files import Settings
from mjcompose.model.grammar import Attribute
from mjcompose.model.select import kind_of, name_of, parent_of
from mjcompose.model.values import parse_real
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import ExpressionError, UnknownName
from mjcompose.text.expression_values import Value
from mjcompose.text.node import Scalar, find, is_template, locate

if TYPE_CHECKING:
    from lxml.etree import _Element as Node

    from mjcompose.build.compose.editing import Editing
    from mjcompose.link.measure import Survey


def report_unusable(editing: Editing, node: Node, fault: Fault, it: str | None = None) -> NoReturn:
    """Report the fault, with the place where the element is written, and raise `UnusableValue`.

    The entry ends there, since the other elements would have the same fault. `it` is what the note calls the element,
    in place of its tag and name.
    """
    notes = fault.all_notes()
    # A number without a unit is a fault of the recipe, wherever the element is.
    if fault.code != "bare-angle":
        notes.append(Note(f"{it or editing.called(node)} is written here", editing.span_of(node)))
    message = fault.message
    span = editing.span(fault.at, key=fault.key)
    help = fault.help
    fix = fault.fix
    editing.sink.error(
        fault.code, message, span, notes=notes, help=help, subjects=(*fault.names, *editing.subjects(node)), fix=fix
    )
    raise UnusableValue


VALUE = "value"
# Newer MuJoCo takes higher coefficients as well; without them it is a number like any other.
POLYNOMIALS = ("damping", "stiffness")
RESERVED = ("name", "parent", "index")


class UnusableValue(Exception):
    """Raised for a value that cannot be determined; the error has been reported."""


@dataclass(frozen=True, slots=True)
class Values:
    """Evaluates the value at a place in the recipe for one element, the one at `index` among the selected ones."""

    editing: Editing
    node: Node
    index: int
    at: Path

    @property
    def scope(self) -> dict[str, Value]:
        parent = parent_of(self.node)
        above = (name_of(parent) if parent is not None and parent.tag != "worldbody" else "world") or ""
        own: dict[str, Value] = {"name": name_of(self.node) or "", "parent": above, "index": self.index}
        return {**self.editing.scope, **own}

    def of(self, written: Any, at: Path, value: Value | None = None) -> Any:
        """Return the written value with its expressions evaluated. Raises `UnusableValue`."""
        if isinstance(written, list | tuple):
            items = value if isinstance(value, tuple) else None
            return [
                self.of(each, (*at, n), items[n] if items is not None and n < len(items) else value)
                for n, each in enumerate(written)
            ]
        if not isinstance(written, str) or not is_template(written):
            return written
        scope = self.scope
        if value is not None:
            scope[VALUE] = value
        found = self.evaluated(written, at, scope, needs_value=value is None)
        return list(found) if isinstance(found, tuple) else found

    def evaluated(self, text: str, at: Path, scope: Mapping[str, Value], *, needs_value: bool = False) -> Value:
        """Return the value of a text with `${…}`. Names that are not in the scope are attributes of the element."""
        try:
            return Template.parse(text).value(scope)
        except ExpressionError as error:
            attribute = kind_of(self.node).attributes.get(error.name) if isinstance(error, UnknownName) else None
            if attribute is not None and (now := self.now(attribute)) is not None:
                return self.evaluated(text, at, {**scope, attribute.name: now}, needs_value=needs_value)
            self._report(error, at, scope, needs_value=needs_value)
            raise UnusableValue from None

    def _report(self, error: ExpressionError, at: Path, scope: Mapping[str, Value], needs_value: bool) -> None:
        editing = self.editing
        node = find(editing.making.document, at)
        span = locate(editing.making.document, at)
        notes = (Note(f"for {editing.called(self.node)}", editing.span_of(self.node)),)
        subjects = editing.subjects(self.node)
        if not isinstance(error, UnknownName):
            editing.sink.error("expression", error.message, span, notes=notes, help=error.help, subjects=subjects)
            return
        subjects = (error.name, *subjects)
        if error.name == VALUE and needs_value:
            what = next(step for step in reversed(at) if isinstance(step, str))
            message = f"`value` does not exist: {editing.called(self.node)} has no `{what}` yet"
            editing.sink.error("expression", message, span, notes=notes, subjects=subjects)
            return
        if error.name in kind_of(self.node).attributes:
            message = f"{editing.called(self.node)} has no `{error.name}`: nothing gives it one"
            editing.sink.error("expression", message, span, notes=notes, subjects=subjects)
            return
        editing.sink.error(
            "unknown-name",
            f"`{error.name}` does not exist in this expression",
            span if not isinstance(node, Scalar) else node.span,
            notes=(exists_note("name", list(scope), error.name),),
            help=did_you_mean(error.name, list(scope)),
            subjects=subjects,
        )

    # -- the present values -------------------------------------------------------------------------------------

    def now(self, attribute: Attribute, index: int | None = None) -> Value | None:
        """Return the effective value or None. Angles are in the recipe's unit, or in radians if it has none."""
        text = self.editing.effective(self.node, attribute.name)
        if text is None or (attribute.is_number and not text.split()):
            return None
        if not attribute.is_number:
            if attribute.type == "bool" or text in ("true", "false"):
                return text == "true"
            return text
        found = self.turned_out(attribute, numbers.read(text))
        values = [int(each) for each in found] if attribute.type == "int" else found
        if index is not None:
            return values[index] if index < len(values) else None
        if attribute.max_length == 1 or (attribute.name in POLYNOMIALS and not any(values[1:])):
            return values[0]
        return tuple(values)

    def turned_out(self, attribute: Attribute, values: list[float]) -> list[float]:
        """Return numbers of the model with their angles in the recipe's unit."""
        making = self.editing.making
        wanted = making.angle_context.at(self.at).angle or "radian"
        if wanted == making.model_angle:
            return values
        turning = self.angles(attribute, len(values))
        factor = numbers.RADIANS_PER_DEGREE if wanted == "radian" else 1 / numbers.RADIANS_PER_DEGREE
        return [each * factor if n in turning else each for n, each in enumerate(values)]

    def angles(self, attribute: Attribute, count: int) -> Iterable[int]:
        """Return which of the numbers of an attribute of this element are angles."""
        from mjcompose.build.compose.editing import is_angular

        if attribute.angle in ("orientation-euler", "replicate"):
            return range(count)
        if attribute.angle == "orientation-axisangle":
            return range(3, count)
        if attribute.angle == "joint" and is_angular(attribute, joint_type(self.node, self.editing.classes)):
            return range(count)
        return range(0)


def attributes_scope(values: Values) -> dict[str, Value]:
    """Return every attribute of the element with its effective value, for `where`."""
    found: dict[str, Value] = {}
    for name, attribute in kind_of(values.node).attributes.items():
        if name.isidentifier() and (now := values.now(attribute)) is not None:
            found[name] = now
    return found


def matches_value(attribute: Attribute, have: Value, wanted: object) -> bool:
    """Return whether an effective value is the one that `where` gives. Numbers are compared up to rounding.

    >>> from mjcompose.model.grammar import GRAMMAR
    >>> matches_value(GRAMMAR.element("geom").attributes["friction"], (1.0, 0.005, 0.0001), [1, 0.005])
    True
    """
    if isinstance(wanted, list | tuple) and isinstance(have, tuple):
        return len(wanted) <= len(have) and all(
            matches_value(attribute, h, w) for h, w in zip(have, wanted, strict=False)
        )
    if isinstance(have, tuple):
        return len(have) == 1 and matches_value(attribute, have[0], wanted)
    if isinstance(have, bool) or isinstance(wanted, bool):
        return have is wanted
    if isinstance(have, int | float):
        if isinstance(wanted, str):
            parsed = parse_real(wanted)
            wanted = wanted if parsed is None else parsed
        return isinstance(wanted, int | float) and abs(have - wanted) <= 1e-9 * max(1.0, abs(have))
    return str(have) == str(wanted)


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
            raise UnusableValue
        mass = None if found is None else found.values(body, "body_mass", 1)
        if mass is None:
            message = f"the mass of {self.editing.called(body)} is not known{hidden}"
            notes = (Note("it is written here", self.editing.span_of(body)),)
            help = "`scale` needs not know it; or write a `mass` on each of its geoms"
            self.editing.sink.error(
                "selector", message, self.editing.span(at), notes=notes, help=help, subjects=self.editing.subjects(body)
            )
            raise UnusableValue
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
            message = f"the mass of {self.editing.called(body)} would be negative"
            span = self.editing.span(at)
            self.editing.sink.error("out-of-range", message, span, subjects=self.editing.subjects(body))
            raise UnusableValue
        self.settle()
        self._scale(body, factor, at)

    @cached_property
    def _survey(self) -> tuple[Survey | None, str]:
        """Return what MuJoCo computes for the model, or None and the reason why it gives no masses."""
        from mjcompose.build.compose.keys import without_keys
        from mjcompose.link.linking import Linking
        from mjcompose.link.measure import Unmeasurable, compile_unaligned

        editing = self.editing
        unit = editing.linking.flat()
        aside = Sink()
        linking = Linking(unit, [], aside, measure=editing.linking.measure)
        with without_keys(unit.root):
            found = compile_unaligned(linking, unit, ("body_mass",))
        if isinstance(found, Unmeasurable):
            return None, f": {found.why}"
        for each in aside.diagnostics:
            editing.sink.add(each)
        return found, ""

    def settle(self, *rules: str) -> None:
        """Rules that change a model after its bodies are written out as what they give, before a body is changed.

        Without `rules` those that change all bodies.
        """
        from mjcompose.build.compose.keys import without_keys
        from mjcompose.link.inertia import MEASURED, write_inertias
        from mjcompose.link.linking import Linking

        editing = self.editing
        unit = editing.linking.flat()
        if all(getattr(unit.settings, name) == getattr(_DEFAULT, name) for name in rules or MEASURED):
            return
        before = editing.sink.error_count
        with without_keys(unit.root):
            write_inertias(Linking(unit, [], editing.sink, measure=editing.linking.measure), unit)
        if editing.sink.error_count > before:
            raise UnusableValue
        editing.linking.base.forget_settings(*MEASURED, "inertiafromgeom", "inertiagrouprange")

    def _inertial(self, body: Node) -> Node | None:
        """Return the effective `<inertial>` of a body, or None."""
        from mjcompose.link.inertia import has_mass

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
        from mjcompose.link.inertia import has_mass

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
        message = f"{editing.called(body)} has no mass of its own that could be scaled"
        span = editing.span(at, key=True)
        notes = (Note("it is written here", editing.span_of(body)),)
        help = self._instead(body)
        editing.sink.error("wrong-type", message, span, notes=notes, help=help, subjects=editing.subjects(body))
        raise UnusableValue

    def _instead(self, body: Node) -> str:
        """Return advice for a body without mass, such as the body that the joint of a part adds."""
        name = body.get("name", "")
        if name.endswith(self.editing.linking.request.separator) and own(body, "body"):
            return f'`{name}` only carries the joint of the part; its bodies are `body: "{name}?**"`'
        return "set `mass` or `density` of a geom in it"
