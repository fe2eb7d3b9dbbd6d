"""The kinds of checks: one file each, with what it is, how it is read and its JSON Schema."""
