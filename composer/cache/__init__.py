"""Build many models of one recipe, with a cache."""
