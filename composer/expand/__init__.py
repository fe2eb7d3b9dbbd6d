"""Expand a recipe with parameters, variants and conditions to one concrete recipe. Works on located trees; no I/O."""
