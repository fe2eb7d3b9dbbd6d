"""Explain where everything in a model came from, and what changed it on the way."""
