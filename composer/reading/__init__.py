"""What may be read: every file that a model, a recipe or a bundle names comes through a door."""
