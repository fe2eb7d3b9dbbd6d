"""The recipe language: its models, their validation, their expansion, and the JSON Schema."""
