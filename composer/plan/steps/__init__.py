"""The steps of a recipe: one file for each type, and the table of all types."""
