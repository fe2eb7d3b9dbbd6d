"""Other programs that run for this one, and that end when it ends, however that happens."""
