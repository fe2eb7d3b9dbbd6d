"""Faults in the globs and regular expressions of selectors and checks."""

from __future__ import annotations

from composer.recipe.fault import Fault, Path
from composer.recipe.reference import Schema
from composer.tree.glob import stray_brace
from composer.tree.pattern import fault_of, is_pattern, is_regular, length_fault

GLOB: Schema = {
    "type": "string",
    "minLength": 1,
    "pattern": r"^/.*/$|\$\{|^(?:[^{}]|\{[^{}]*\})*$",
    "patternErrorMessage": "a choice is `{a,b}`, with no other one in it",
}
"""A glob or a regular expression over names."""


def pattern_fault(text: str, owner: str, at: Path) -> Fault | None:
    """Return the fault of the pattern with which `owner` is compared, or None."""
    if is_pattern(text) and (wrong := length_fault(text)) is not None:
        return Fault(
            "wrong-type",
            f"{owner}: {wrong}",
            at,
            help="give the elements a class or a `part`, or write several entries",
        )
    if is_regular(text):
        wrong = fault_of(text[1:-1])
        return (
            Fault("wrong-type", f"the regular expression of {owner} is not valid: {wrong}", at)
            if wrong
            else None
        )
    stray = stray_brace(text)
    if stray is None:
        return None
    message = f"the `{text[stray]}` in the glob `{text}` of {owner} is part of no choice"
    help = "a choice is `{a,b}`, with no other one in it; `/(a|b)[{]c/` is a regular expression"
    return Fault("wrong-type", message, at, help=help)
