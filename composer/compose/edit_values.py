"""Evaluate the `${…}` in an edit for one element with its current values, and convert angles to the model's unit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from lxml.etree import _Element as Node

from composer.compose.editing import Editing, is_angular
from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.diagnostics.suggest import did_you_mean, exists_note
from composer.document.node import Scalar, find, locate
from composer.expr.error import ExpressionError, UnknownName
from composer.expr.opening import is_template
from composer.expr.template import Template
from composer.expr.value import Value
from composer.grammar.attribute import Attribute
from composer.grammar.number import parse_real
from composer.link import numbers
from composer.link.layout import joint_type
from composer.recipe.fault import Path
from composer.tree.kinds import kind_of
from composer.tree.select import name_of, parent_of

VALUE = "value"
# Newer MuJoCo takes higher coefficients as well; without them it is a number like any other.
POLYNOMIALS = ("damping", "stiffness")
RESERVED = ("name", "parent", "index")


class Unusable(Exception):
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
        """Return the written value with its expressions evaluated. Raises `Unusable`."""
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

    def evaluated(
        self, text: str, at: Path, scope: Mapping[str, Value], *, needs_value: bool = False
    ) -> Value:
        """Return the value of a text with `${…}`. Names that are not in the scope are attributes of the element."""
        try:
            return Template.parse(text).value(scope)
        except ExpressionError as error:
            attribute = (
                kind_of(self.node).attributes.get(error.name) if isinstance(error, UnknownName) else None
            )
            if attribute is not None and (now := self.now(attribute)) is not None:
                return self.evaluated(text, at, {**scope, attribute.name: now}, needs_value=needs_value)
            self._report(error, at, scope, needs_value=needs_value)
            raise Unusable from None

    def _report(
        self, error: ExpressionError, at: Path, scope: Mapping[str, Value], needs_value: bool
    ) -> None:
        editing = self.editing
        node = find(editing.making.document, at)
        span = locate(editing.making.document, at)
        notes = (Note(f"for {editing.called(self.node)}", editing.span_of(self.node)),)
        subjects = editing.subjects(self.node)
        if not isinstance(error, UnknownName):
            editing.sink.error(
                "expression",
                error.message,
                span,
                notes=notes,
                help=error.help,
                subjects=subjects,
            )
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


def equal(attribute: Attribute, have: Value, wanted: object) -> bool:
    """Return whether an effective value is the one that `where` gives. Numbers are compared up to rounding.

    >>> from composer.grammar import GRAMMAR
    >>> equal(GRAMMAR.element("geom").attributes["friction"], (1.0, 0.005, 0.0001), [1, 0.005])
    True
    """
    if isinstance(wanted, list | tuple) and isinstance(have, tuple):
        return len(wanted) <= len(have) and all(
            equal(attribute, h, w) for h, w in zip(have, wanted, strict=False)
        )
    if isinstance(have, tuple):
        return len(have) == 1 and equal(attribute, have[0], wanted)
    if isinstance(have, bool) or isinstance(wanted, bool):
        return have is wanted
    if isinstance(have, int | float):
        if isinstance(wanted, str):
            parsed = parse_real(wanted)
            wanted = wanted if parsed is None else parsed
        return isinstance(wanted, int | float) and abs(have - wanted) <= 1e-9 * max(1.0, abs(have))
    return str(have) == str(wanted)
