"""Values that the grammar of MJCF reads: those of attributes, and selectors."""

from __future__ import annotations

from typing import Any

from mjcompose.base.diagnostic import Fault
from mjcompose.language.element_schema import attribute_schema
from mjcompose.language.forms.context import ByGrammar, Settings
from mjcompose.language.forms.definitions import Schema, reference
from mjcompose.language.forms.model import OWNER
from mjcompose.language.select import check_template, read_selector
from mjcompose.language.value import bare_angle, read_value
from mjcompose.text.node import is_template
from mjcompose.tree.grammar import GRAMMAR
from mjcompose.tree.grammar import Attribute as Declared
from mjcompose.tree.pattern import Selector


class Attribute(ByGrammar):
    """The value of an attribute of an element, by the path of the element in the grammar.

    With `computed`, `${…}` is computed for each element, and a value that has it stays as it is written. Otherwise the
    value is the value in MJCF: a list is a tuple.

    ``pos: Annotated[Vector | None, Attribute("frame", "pos")] = None``
    """

    def __init__(self, element: str, name: str, *, computed: bool = False) -> None:
        self.element, self.name, self.computed = element, name, computed

    @property
    def declared(self) -> Declared:
        return GRAMMAR.element(self.element).attributes[self.name]

    def schema(self) -> Schema:
        return attribute_schema(self.declared)

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        if self.computed and _is_computed(value, faults):
            return value
        read = read_value(self.declared, value, (), owner=OWNER, faults=faults)
        if read is not None and not faults and not settings.bare_angles:
            bare = bare_angle(self.declared, read, None, at=(), owner=OWNER)
            faults += [bare] if bare is not None else []
        return value if self.computed else read


class Selects(ByGrammar):
    """A selector, which is read as `Selector`."""

    def schema(self) -> Schema:
        return reference("selector")

    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Selector | None:
        return read_selector(value, (), f"`select` of {OWNER}", faults=faults)


def _is_computed(value: Any, faults: list[Fault]) -> bool:
    """Return whether a value has `${…}`. Text that cannot be parsed is a fault."""
    found = False
    for index, each in enumerate(value) if isinstance(value, list) else ((None, value),):
        if isinstance(each, str) and is_template(each):
            check_template(each, () if index is None else (index,), faults)
            found = True
    return found
