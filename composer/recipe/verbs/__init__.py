"""The verbs of `edit`: how each is written. Each has one file; `table` has them all."""
