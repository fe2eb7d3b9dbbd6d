"""Many models of one recipe."""
