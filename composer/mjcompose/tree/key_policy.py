"""How the keys of a part are copied."""

from typing import Literal

KeyPolicy = Literal["merge", "prefix", "none"]
"""Merged by name, kept apart by their prefix, or not at all."""
