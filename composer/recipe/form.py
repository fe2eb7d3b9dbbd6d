"""The form of a value in a recipe: how it is read, and its JSON Schema."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from composer.dataclass import dataclass
from composer.recipe.fault import Fault, validation_error
from composer.recipe.reference import Schema
from composer.recipe.settings import Settings, settings


@dataclass(frozen=True, slots=True)
class Form(ABC):
    """An annotation for a field of a pydantic model, such as `seed: Annotated[int, Whole("seed", 0, 9)]`."""

    @abstractmethod
    def read(self, value: Any, faults: list[Fault], settings: Settings) -> Any:
        """Return the value of the field. Faults are added to `faults`, with paths below it, and make the value void."""

    @abstractmethod
    def schema(self) -> Schema:
        """Return the JSON Schema of what may be written."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> Schema:
        return self.schema()

    def _validate(self, value: Any, info: ValidationInfo) -> Any:
        faults: list[Fault] = []
        read = self.read(value, faults, settings(info.context))
        if faults:
            raise validation_error(faults, value)
        return read
