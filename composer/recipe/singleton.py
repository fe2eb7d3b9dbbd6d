"""Sections of which a model has one: `option`, `size`, `statistic`, `visual`, `compiler`."""

from __future__ import annotations

from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.diagnostic import Note
from composer.recipe.element import Element
from composer.recipe.element_schema import element
from composer.recipe.fault import Fault
from composer.recipe.reader import FRAGMENT, Reader
from composer.recipe.reference import Schema
from composer.recipe.section import Section


@dataclass(frozen=True, slots=True)
class Singleton(Section):
    """Form of such a section: a mapping of its attributes and children.

    It is read as an `Element`. With `settable`, only those keys are allowed.
    """

    settable: frozenset[str] = frozenset()

    def content(self, reader: Reader, value: Any) -> Element | None:
        if self.settable and isinstance(value, dict):
            kind = self.kind
            value = dict(value)
            for name in [
                n for n in value if n not in self.settable and (n in kind.attributes or n == FRAGMENT)
            ]:
                reader.faults.append(self._unsettable(name))
                del value[name]
        return reader.element(self.kind, value, (), f"`{self.tag}`")

    def schema(self) -> Schema:
        schema = element(self.kind)
        if self.settable:
            properties = schema["properties"].items()
            schema["properties"] = {name: each for name, each in properties if name in self.settable}
        return schema

    def _unsettable(self, name: str) -> Fault:
        top = name in ("angle", "eulerseq")
        return Fault(
            "compiler-setting",
            f"`{name}` cannot be set in `{self.tag}`: each part keeps its own",
            (name,),
            key=True,
            notes=(Note(f"what can be set: {', '.join(sorted(self.settable))}"),),
            help=f"for the recipe's own elements, write `{name}` at the top of the recipe"
            if top
            else f"leave `{name}` out",
        )
