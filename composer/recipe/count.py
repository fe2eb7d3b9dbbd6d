"""How many elements a selector must match: `expect` and `optional` beside it."""

from __future__ import annotations

from typing import Any

from composer.recipe.fault import Fault, Path
from composer.recipe.reference import Schema, reference
from composer.recipe.shown import kind_of

SCHEMAS: dict[str, Schema] = {
    "expect": {**reference("integer"), "minimum": 0, "description": "how many elements must be selected"},
    "optional": {"type": "boolean", "description": "whether it may be that nothing is selected"},
}
COUNT = tuple(SCHEMAS)


def read_count(
    value: dict[str, Any], at: Path, faults: list[Fault], owner: str = ""
) -> tuple[int | None, bool]:
    """Return the number, None for at least one, and whether none is allowed. `owner` is the subject of messages."""
    expect, optional = value.get("expect"), value.get("optional", False)
    of = f" of {owner}" if owner else ""
    if "expect" in value and (isinstance(expect, bool) or not isinstance(expect, int) or expect < 0):
        message = f"`expect`{of} is how many elements there must be, a whole number, got {kind_of(expect)}"
        faults.append(Fault("wrong-type", message, (*at, "expect")))
        expect = None
    if not isinstance(optional, bool):
        message = f"`optional`{of} is `true` or `false`, got {kind_of(optional)}"
        faults.append(Fault("wrong-type", message, (*at, "optional")))
    return expect, bool(optional)
