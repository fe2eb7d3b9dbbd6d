"""How a section of MJCF is read by the grammar, inside of a pydantic model.

Each form of section has a class of its own, which is put on a field of the recipe:
`sensor: Annotated[tuple[Element, ...], Typed("sensor")]`. That is how there are types for 170 elements
without as many models.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from composer.diagnostics.suggest import closest, exists_note
from composer.grammar import GRAMMAR
from composer.grammar.element import ElementType
from composer.recipe.fault import Fault, Path, Remark, refusal
from composer.recipe.reader import Reader
from composer.recipe.settings import settings
from composer.recipe.shown import kind_of


@dataclass(frozen=True, slots=True)
class Section:
    """What all forms share. `form` names their JSON Schema."""

    tag: str
    form: ClassVar[str]

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        from composer.recipe.element_schema import section

        return section(self.form, self.tag)

    def _validate(self, value: Any, info: ValidationInfo) -> Any:
        reader = Reader(settings(info.context))
        result = self.read(reader, value)
        if reader.faults:
            raise refusal(reader.faults, value)
        return result

    def read(self, reader: Reader, value: Any) -> Any:
        """The content of the section; faults go to the reader."""
        raise NotImplementedError

    @property
    def kind(self) -> ElementType:
        return GRAMMAR.section(self.tag)

    def tags(self, reader: Reader, value: Any) -> list[tuple[ElementType, Any, Path]]:
        """The entries of a mapping from tag to elements."""
        if not isinstance(value, dict):
            message = f"`{self.tag}` expects a mapping from tags to elements, got {kind_of(value)}"
            help = (
                "write the tag as a key: `TAG: …`, not as an item of a list"
                if isinstance(value, list)
                else None
            )
            reader.faults.append(Fault("wrong-type", message, help=help))
            return []
        known: list[tuple[ElementType, Any, Path]] = []
        for tag, item in value.items():
            if tag in self.kind.children:
                known.append((self.kind.children[tag], item, (tag,)))
            else:
                reader.faults.append(
                    self.unknown(tag, (tag,), f"`{self.tag}` has no element `{tag}`", key=True)
                )
        return known

    def unknown(self, tag: str, at: Path, message: str, key: bool) -> Fault:
        """The fault of a tag that the section does not have."""
        near = closest(tag, self.kind.children)
        remark = Remark(exists_note(f"{self.tag} element", self.kind.children, tag).message)
        help = f"write `{near[0]}`" if near else None
        return Fault("unknown-element", message, at, key=key, remarks=(remark,), help=help)


@dataclass(frozen=True, slots=True)
class Elements(Section):
    """Sections that give a tuple of `Element`, each of which is appended to the section of the model."""
