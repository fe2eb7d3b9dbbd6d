"""The targets. Each has one file."""
