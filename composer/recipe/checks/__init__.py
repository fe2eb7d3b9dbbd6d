"""The kinds of checks. Each has one file with its meaning, its form and its JSON Schema."""
