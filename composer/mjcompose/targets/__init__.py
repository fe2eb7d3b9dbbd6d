"""Models as other programs read them, and what these cannot express."""
