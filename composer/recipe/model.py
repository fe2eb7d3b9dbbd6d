"""The base class of all pydantic models of the recipe."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Model(BaseModel):
    """A mapping with fixed keys: frozen, no other keys, nothing converted."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        # Most models are never validated on their own. Building their validators would be most of the import time.
        defer_build=True,
        hide_input_in_errors=True,
    )
