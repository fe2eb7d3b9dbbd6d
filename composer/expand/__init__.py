"""From a recipe with parameters, variants and conditions to one concrete recipe. Located trees in and out; no I/O."""
