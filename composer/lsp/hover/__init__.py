"""Hover: information about what is at the cursor. Each kind has one file and one row in `table`."""
