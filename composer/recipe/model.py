"""What all pydantic models of the recipe share."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """A mapping with fixed keys: frozen, no other keys, nothing converted."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        # What is never validated on its own need not be built; this is most of the import time.
        defer_build=True,
        hide_input_in_errors=True,
    )
