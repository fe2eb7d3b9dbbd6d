"""Numeric expressions, `${…}` in a recipe: total, bounded, and with no way out of arithmetic."""
