"""Numeric expressions, `${…}` in a recipe: always ending, bounded, and limited to arithmetic."""
