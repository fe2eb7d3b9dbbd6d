"""What targets cannot express: one file for each restriction, used by the rows of all targets that have it."""
