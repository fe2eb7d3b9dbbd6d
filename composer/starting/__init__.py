"""Starting points for newcomers: a recipe, or a complete repository."""
