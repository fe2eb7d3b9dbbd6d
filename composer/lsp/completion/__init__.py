"""What can be written at a place of a recipe: one file a kind, one row in `table`."""
