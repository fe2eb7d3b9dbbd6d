"""The canonical layout of recipes: what `mjcompose fmt` writes."""
