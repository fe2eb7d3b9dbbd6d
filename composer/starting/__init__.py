"""What a newcomer starts from: a recipe, or a repository with everything around it."""
