"""Judge a built model: it compiles, and each of its parts is the same as its source alone."""
