"""Completion. Each kind has one file and one row in `table`."""
