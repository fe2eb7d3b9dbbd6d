"""Settings at the top of a recipe that affect everything below."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from composer.dataclass import dataclass
from composer.diagnostics.suggest import closest

DEFAULT_SEPARATOR = "/"


@dataclass(frozen=True, slots=True)
class Settings:
    """The context of a validation.

    With `bare_angles`, angles without a unit are allowed. `separator` is between a prefix and a name.
    """

    bare_angles: bool = True
    separator: str = DEFAULT_SEPARATOR

    @classmethod
    def of(cls, data: object) -> Settings:
        """Return the settings of the top-level keys of a recipe. One that is wrong or misspelled counts as given."""
        if not isinstance(data, Mapping):
            return cls()
        separator = data.get("separator", DEFAULT_SEPARATOR)
        bare_angles = any(key == "angle" or closest(str(key), ["angle"]) for key in data)
        return cls(bare_angles, separator if isinstance(separator, str) and separator else DEFAULT_SEPARATOR)


def settings(context: Any) -> Settings:
    """Return the settings in a pydantic context, or lenient ones if there are none."""
    return context if isinstance(context, Settings) else Settings()
