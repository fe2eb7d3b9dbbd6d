"""Access control for reading: every file that a model, a recipe or a bundle names passes a door."""
