"""Values in an edit for one element, and the mass of a body."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from functools import cached_property
from typing import TYPE_CHECKING, Any, NoReturn

from lxml.etree import _Element as Node

from mjcompose.base.dataclass import dataclass
from mjcompose.base.diagnostic import Fault, Note, Path, Span
from mjcompose.base.sink import Sink
from mjcompose.base.suggest import did_you_mean, exists_note
from mjcompose.language.parameters import within
from mjcompose.language.value import angle_places, attribute_and_index
from mjcompose.link import numbers
from mjcompose.link.inertia import INERTIA_RULES, MEASURED, has_mass, static_bodies, write_inertias
from mjcompose.link.key_layout import JOINTS, joint_type
from mjcompose.link.linking import Linking
from mjcompose.link.measure import Survey, Unmeasurable, compile_unaligned
from mjcompose.link.unit_keys import without_keys
from mjcompose.text.evaluate import Template
from mjcompose.text.expression import (
    ELEMENT,
    PARAMETERS,
    Angle,
    ExpressionError,
    Number,
    Unit,
    UnknownName,
    Value,
    Variable,
    WrongUnits,
    written as as_written,
)
from mjcompose.text.node import Scalar, find, is_template, locate
from mjcompose.tree import journal
from mjcompose.tree.classes import childclass_of, own
from mjcompose.tree.files import SourceSettings
from mjcompose.tree.grammar import Attribute
from mjcompose.tree.select import kind_of, name_of, parent_of
from mjcompose.tree.values import is_in_degrees, parse_real

if TYPE_CHECKING:
    from mjcompose.compose.editing import Editing


def report_unusable(editing: Editing, node: Node, fault: Fault, it: str | None = None) -> NoReturn:
    """Report the fault with the place of the element, `it`, and raise `UnusableValue`, which ends the entry."""
    notes: list[Note] = fault.all_notes()
    if fault.code != "bare-angle":  # the place of the element does not matter for a number without a unit
        notes.append(Note(f"{it or editing.called(node)} is written here", editing.span_of(node)))
    span = editing.span(fault.at, key=fault.key)
    subjects = (*fault.names, *editing.subjects(node))
    if not fault.key:
        span = span.taken_from(_source(editing, node, fault.at))
    editing.sink.error(fault.code, fault.message, span, notes=notes, help=fault.help, subjects=subjects, fix=fault.fix)
    raise UnusableValue


def _source(editing: Editing, node: Node, at: Path) -> Span | None:
    """Return where a table has the value of an expression for an element; None for other values."""
    written = find(editing.making.document, at)
    if not isinstance(written, Scalar) or not is_template(written.text):
        return None
    try:
        template = Template.parse(written.text)
        return template.place(ElementScope(EntryValues(editing, node, 0, at=at)))
    except (ExpressionError, AmbiguousName):
        return None


VALUE = "value"
# Newer MuJoCo has higher coefficients. Without them, the value is one number.
POLYNOMIALS = ("damping", "stiffness")
RESERVED = ("name", "parent", "index")


class UnusableValue(Exception):
    """Raised for a value that cannot be determined; the error has been reported."""


class AmbiguousName(Exception):
    """Raised for a name that is a parameter and an attribute of the element."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.name = name


class ElementScope(Mapping[str, Value]):
    """The names of an expression about an element, in `where` and in every verb alike.

    They are `name`, `parent`, `index` and `value`, the parameters and variants of the recipe, and the attributes of
    the element. A name that is a parameter and an attribute is ambiguous: `params.NAME` is the parameter and
    `element.NAME` the attribute. Only the attribute that is `written` has a name of its own there, `value`.
    """

    def __init__(self, values: EntryValues, value: Value | None = None, written: str = "") -> None:
        self.entry = values
        self.value = value
        self.written = written
        self.parameters = values.editing.scope
        self.attributes = kind_of(values.node).attributes

    def __getitem__(self, key: str) -> Value:
        found = self._own(key) if key in RESERVED or key == VALUE else self._other(key)
        if found is None:
            raise KeyError(key)
        return found

    def __iter__(self) -> Iterator[str]:
        yield from self.parameters
        yield from RESERVED
        if self.value is not None:
            yield VALUE

    def __len__(self) -> int:
        return sum(1 for _ in iter(self))

    def names_in(self, space: str) -> Collection[str]:
        """Return the names that exist: all, or those of `params` or `element`."""
        if space == ELEMENT:
            return [name for name, each in self.attributes.items() if self.entry.now(each) is not None]
        return self.parameters if space == PARAMETERS else [*self]

    def _own(self, key: str) -> Value | None:
        if key == VALUE:
            return self.value
        return self.entry.position if key == "index" else self.entry.called[key]

    def _other(self, key: str) -> Value | None:
        space, _, name = key.rpartition(".")
        attribute = self.attributes.get(name) if space != PARAMETERS else None
        if space != ELEMENT and name in self.parameters:
            if attribute is not None and name != self.written:
                raise AmbiguousName(name)
            return self.parameters[name]
        return None if attribute is None else self.entry.now(attribute)


@dataclass(frozen=True, slots=True)
class EntryValues:
    """The values that an entry gives to one element, which has the `index` among the selected ones."""

    editing: Editing
    node: Node
    index: int
    at: Path
    count: Callable[[], int] | None = None
    """The index, if it takes a walk to count it."""

    @property
    def called(self) -> dict[str, str]:
        """The names of the element and of its parent."""
        parent = parent_of(self.node)
        above = (name_of(parent) if parent is not None and parent.tag != "worldbody" else "world") or ""
        return {"name": name_of(self.node) or "", "parent": above}

    @property
    def position(self) -> int:
        return self.index if self.count is None else self.count()

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
        return as_written(self.evaluated(written, at, value))

    def evaluated(self, text: str, at: Path, value: Value | None = None) -> Value:
        """Return the value of a text with `${…}`; `value` is the present value of the place. Raises `UnusableValue`."""
        key = next((step for step in reversed(at) if isinstance(step, str)), "")
        scope = ElementScope(self, value, attribute_and_index(key)[0])
        try:
            template = Template.parse(text)
            return template.value(scope)
        except AmbiguousName as ambiguous:
            named = next(each for each in template.names() if each.key == ambiguous.name)
            self._report(_ambiguous(named, self.editing.called(self.node)), at, scope)
        except ExpressionError as error:
            self._report(error, at, scope)
        raise UnusableValue

    def _report(self, error: ExpressionError, at: Path, scope: ElementScope) -> None:
        editing = self.editing
        node = find(self.editing.making.document, at)
        called = editing.called(self.node)
        span = locate(editing.making.document, at)
        if isinstance(node, Scalar):
            span = within(node, *error.at)
        notes: tuple[Note, ...] = (Note(f"for {called}", editing.span_of(self.node)),)
        code = "expression"
        message = error.message
        help = error.help
        subjects = editing.subjects(self.node)
        if isinstance(error, WrongUnits) and (kind := self.joint_type) not in (None, "hinge"):
            help = f"a {kind} has no angle here: write `type == 'hinge' and …` in `where` for hinges alone"
        if isinstance(error, UnknownName):
            subjects = (error.name, *subjects)
            help = None
            if error.name == VALUE and scope.value is None:
                key = next(step for step in reversed(at) if isinstance(step, str))
                message = f"`value` does not exist: {called} has no `{key}` yet"
            elif error.space != PARAMETERS and error.name in scope.attributes:
                message = f"{called} has no `{error.name}`"
            else:
                known = scope.names_in(error.space)
                span = node.span if isinstance(node, Scalar) else span
                notes = (exists_note("name", known, error.name),)
                code = "unknown-name"
                message = f"{error.message} in this expression"
                help = did_you_mean(error.name, known)
        editing.sink.error(code, message, span, notes=notes, help=help, subjects=subjects)

    def now(self, attribute: Attribute, index: int | None = None) -> Value | None:
        """Return the effective value or None. Angles are in the recipe's unit, or in radians if it has none."""
        text = self.editing.effective(self.node, attribute.name)
        if text is None or (attribute.is_number and not text.split()):
            return None
        if not attribute.is_number:
            if attribute.type == "bool" or text in ("true", "false"):
                return text == "true"
            return text
        values: list[Number | Angle] = [*numbers.read(text)]
        if attribute.type == "int":
            values = [numbers.integer(item) for item in text.split()]
        self._turn(attribute, values)
        if index is not None:
            return values[index] if index < len(values) else None
        if attribute.max_length == 1 or (attribute.name in POLYNOMIALS and not any(values[1:])):
            return values[0]
        return tuple(values)

    def _turn(self, attribute: Attribute, values: list[Number | Angle]) -> None:
        """Replace the numbers that are angles by angles."""
        if is_in_degrees(str(self.node.tag), attribute.name):
            values[:] = [Angle(float(each), "deg") for each in values if not isinstance(each, Angle)]
            return
        if attribute.angle is None:
            return
        making = self.editing.making
        unit: Unit = "deg" if making.angle_context.at(self.at).angle == "degree" else "rad"
        model: Unit = "deg" if making.model_angle == "degree" else "rad"
        for place in self.angles(attribute, len(values)):
            number = values[place]
            if not isinstance(number, Angle):
                values[place] = Angle(_turned(number, model, unit), unit)

    @property
    def joint_type(self) -> str | None:
        return joint_type(self.node, self.editing.classes) if self.node.tag == "joint" else None

    def angles(self, attribute: Attribute, count: int) -> Iterable[int]:
        """Return which of the numbers of an attribute of this element are angles."""
        return angle_places(attribute, count, self.joint_type if attribute.angle == "joint" else None)


def _turned(number: float, unit: Unit, to: Unit) -> float:
    if unit == to:
        return number
    return number * numbers.RADIANS_PER_DEGREE if to == "rad" else number / numbers.RADIANS_PER_DEGREE


def _ambiguous(name: Variable, called: str) -> ExpressionError:
    message = f"`{name.name}` is a parameter, and an attribute of {called}"
    help = f"write `{PARAMETERS}.{name.name}` for the parameter, or `{ELEMENT}.{name.name}` for the attribute"
    return ExpressionError(message, name.at, help)


def matches_value(attribute: Attribute, have: Value, wanted: object) -> bool:
    """Return whether an effective value is the value that `where` gives. Numbers are compared up to rounding.

    A bare number is compared in the unit of the angle.

    >>> from mjcompose.tree.grammar import GRAMMAR
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
    if isinstance(have, Angle):
        angle = Angle.read(wanted) if isinstance(wanted, str) else None
        wanted = wanted if angle is None else angle.in_unit(have.unit)
        have = have.value
    if isinstance(have, int | float):
        if isinstance(wanted, str):
            angle = Angle.read(wanted)
            parsed = parse_real(wanted)
            wanted = angle.radians if angle is not None else wanted if parsed is None else parsed
        return isinstance(wanted, int | float) and abs(have - wanted) <= 1e-9 * max(1.0, abs(have))
    return str(have) == str(wanted)


_DENSITY = 1000.0
_OF_INERTIAL = ("mass", "diaginertia", "fullinertia")
_DEFAULT = SourceSettings()


class Masses:
    """The masses of bodies; one call to MuJoCo measures all masses that the tree does not determine.

    `found` are the bodies of the entry. A body that `fusestatic` will fuse has no mass of its own: it is part of the
    body above, whose mass includes it.
    """

    def __init__(self, editing: Editing, found: Collection[Node] = ()) -> None:
        self.editing = editing
        self.found = found

    def of(self, body: Node, at: Path) -> float:
        """Return the mass that MuJoCo computes for a body without its children, in kg."""
        if (mass := self._as_written(body)) is not None:
            return mass
        survey, hidden = self._measured()
        if survey is not None:
            self._check_not_fused(body, survey, at)
        found = None if survey is None else survey.values(body, "body_mass", 1)
        if found is None:
            message = f"the mass of {self.editing.called(body)} is not known{hidden}"
            help = "use `scale`, which does not need the mass, or write a `mass` on each of its geoms"
            report_unusable(self.editing, body, Fault("selector", message, at, help=help), it="it")
        return found[0]

    def _as_written(self, body: Node) -> float | None:
        """Return the mass that the elements of a body say, or None if only MuJoCo knows it."""
        if self._has_rules or self._may_fuse:
            return None
        if (inertial := self._inertial(body)) is not None:
            return numbers.first(str(inertial.get("mass") or "0"))
        masses = [self.editing.effective(geom, "mass") for geom in own(body, "geom")]
        if not masses or any(mass is None for mass in masses):
            return None
        return sum(numbers.first(str(mass)) for mass in masses)

    def _check_not_fused(self, body: Node, survey: Survey, at: Path) -> None:
        if not survey.is_gone(body) or (host := self._host(body, survey)) is None:
            return
        whole = self.editing.called(host)
        message = f"{self.editing.called(body)} has no mass of its own: `fusestatic` makes it part of {whole}"
        help = f"change the mass of {whole}, which includes it, or of a geom in it"
        report_unusable(self.editing, body, Fault("wrong-type", message, at, key=True, help=help), it="it")

    @property
    def _has_rules(self) -> bool:
        """Return whether a compiler rule changes the masses that the tree says."""
        settings = self.editing.linking.flat().settings
        return any(getattr(settings, name).split() != getattr(_DEFAULT, name).split() for name in INERTIA_RULES)

    @property
    def _may_fuse(self) -> bool:
        return self.editing.linking.flat().settings.fusestatic == "true"

    def _measured(self) -> tuple[Survey | None, str]:
        before = self.editing.sink.error_count
        found = self._survey
        if self.editing.sink.error_count > before:
            raise UnusableValue
        return found

    def _host(self, body: Node, survey: Survey) -> Node | None:
        """Return the body that a fused body becomes part of, or None for the world."""
        return next((above for above in body.iterancestors("body") if not survey.is_gone(above)), None)

    def _fused(self, body: Node, at: Path) -> list[Node]:
        """Return the bodies that become part of this body."""
        below = [each for each in body.iterdescendants("body") if not own(each, *JOINTS)] if self._may_fuse else []
        if not below:
            return []
        survey, hidden = self._measured()
        if survey is None:
            message = f"the bodies that `fusestatic` makes part of {self.editing.called(body)} are not known{hidden}"
            report_unusable(self.editing, body, Fault("selector", message, at), it="it")
        return [each for each in below if survey.is_gone(each) and self._host(each, survey) is body]

    def change(self, body: Node, verb: str, given: float, now: float | None, at: Path) -> None:
        """Multiply the mass and inertia of a body by the factor that follows from the verb and the number."""
        factor = given
        if verb != "scale":
            assert now is not None
            if now == 0:
                self._report_no_mass(body, at)
            factor = (given if verb == "set" else now + given) / now
        if factor < 0 or not math.isfinite(factor):
            message = f"the mass of {self.editing.called(body)} would be negative"
            span = self.editing.span(at)
            self.editing.sink.error("out-of-range", message, span, subjects=self.editing.subjects(body))
            raise UnusableValue
        if self._may_fuse:
            survey, _ = self._measured()
            if survey is not None and survey.is_gone(body) and self._host(body, survey) in self.found:
                return  # the mass of the host, which changes by its own factor, includes it
        fused = self._fused(body, at)
        self.settle()
        self._scale(body, fused, factor, at)

    @cached_property
    def _survey(self) -> tuple[Survey | None, str]:
        """Return MuJoCo's results for the model, or None and the reason why it gives no masses."""
        editing = self.editing
        unit = editing.linking.flat()
        aside = Sink()
        linking = Linking(unit, [], aside, measure=editing.linking.measure)
        with without_keys(unit.root):
            # Below a joint of the recipe, bodies that would be part of the world alone keep their mass.
            pinned = static_bodies(unit) if self._may_fuse else ()
            found = compile_unaligned(linking, unit, ("body_mass",), pinned=pinned)
        if isinstance(found, Unmeasurable):
            return None, f": {found.why}"
        editing.sink.extend(aside.diagnostics)
        return found, ""

    def settle(self, *rules: str) -> None:
        """Write out the results of compiler rules before a body is changed. Without `rules`, all rules for bodies."""
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
        inertials = own(body, "inertial")
        # With `inertiafromgeom="true"` an `<inertial>` holds only on bodies whose geoms have no mass: this weighs 2 kg.
        #   <body><inertial mass="9" pos="0 0 0" diaginertia="1 1 1"/><geom size="1" mass="2"/></body>
        if self.editing.linking.flat().settings.inertiafromgeom != "true":
            return inertials[-1] if inertials else None
        return inertials[-1] if inertials and not self._geoms_with_mass(body) else None

    def _geoms_with_mass(self, body: Node) -> list[Node]:
        """Return the geoms whose mass counts."""
        editing = self.editing
        low, high = (int(bound) for bound in editing.linking.flat().settings.inertiagrouprange.split())
        return [
            geom
            for geom in own(body, "geom")
            if low <= int(editing.effective(geom, "group") or 0) <= high and has_mass(geom, editing.classes)
        ]

    def _scale(self, body: Node, fused: Iterable[Node], factor: float, at: Path) -> None:
        from_geoms = self.editing.linking.flat().settings.inertiafromgeom != "false"
        whole = [body, *fused]
        inertials = {each: self._inertial(each) for each in whole}
        geoms = [
            geom for each in whole if inertials[each] is None for geom in self._geoms_with_mass(each) if from_geoms
        ]
        if not geoms and not any(each is not None for each in inertials.values()):
            self._report_no_mass(body, at)
        for inertial in inertials.values():
            if inertial is not None:
                self._scale_inertial(inertial, factor, at)
        for geom in geoms:
            self._scale_geom(geom, factor, at)

    def _scale_inertial(self, inertial: Node, factor: float, at: Path) -> None:
        # The moments follow the mass, as if the same body were of another material.
        for name in _OF_INERTIAL:
            if text := inertial.get(name):
                journal.write(inertial, name, numbers.text(factor * each for each in numbers.read(str(text))))
        self.editing.write(inertial, dict.fromkeys(_OF_INERTIAL, at))

    def _scale_geom(self, geom: Node, factor: float, at: Path) -> None:
        classes = self.editing.classes
        childclass = childclass_of(geom)
        mass = classes.effective(geom, childclass, "mass")
        # `mass="nan"` cancels the mass that a class gives: then the density counts.
        if mass is not None and not math.isnan(numbers.first(mass)):
            name = "mass"
            value = numbers.first(mass)
        else:
            density = classes.effective(geom, childclass, "density")
            name = "density"
            value = _DENSITY if density is None else numbers.first(density)
        journal.write(geom, name, numbers.text([factor * value]))
        self.editing.write(geom, {name: at})

    def _report_no_mass(self, body: Node, at: Path) -> NoReturn:
        editing = self.editing
        help = "set `mass` or `density` of a geom in it"
        name = body.get("name", "")
        if name.endswith(editing.linking.request.separator) and own(body, "body"):  # the joint of a part adds it
            help = f'`{name}` only carries the joint of the part; its bodies are `body: "{name}?**"`'
        message = f"{editing.called(body)} has no mass of its own to scale"
        report_unusable(editing, body, Fault("wrong-type", message, at, key=True, help=help), it="it")
