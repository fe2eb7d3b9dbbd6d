"""Programs for environments of their own: each reads a model in another simulator."""
