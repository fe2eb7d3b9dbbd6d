"""Draws in words: what is drawn, for what, and from which distribution."""

from __future__ import annotations

from composer.recipe.draw_field import DrawField

_SIGNS = {"set": "=", "scale": "×", "offset": "+"}


def words_of_draw(field: DrawField) -> str:
    """A field on one line."""
    what = f"the parameter {field.param}" if field.param is not None else f"{field.attr} of {field.select}"
    shared = ", one for all" if field.per == "sample" else ""
    return f"draw {field.name}: {what} {_SIGNS[field.operation]} {field.drawing}{shared}"
