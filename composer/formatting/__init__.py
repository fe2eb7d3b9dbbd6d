"""The canonical layout of recipes, written by `mjcompose fmt`."""
