"""Pictures and films of a recipe, a model or a bundle."""
