"""Models as other programs read them, and the limits of these programs."""
