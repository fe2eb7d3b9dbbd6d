"""Whether what was built is right: it compiles, its parts are what they are alone."""
