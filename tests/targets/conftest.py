"""The readers run in environments of their own."""

collect_ignore = ["readers"]
