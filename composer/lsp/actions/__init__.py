"""Changes that are offered: one file a kind, one row in `table`."""
