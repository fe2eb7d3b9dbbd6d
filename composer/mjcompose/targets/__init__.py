"""Models in the form that other programs read, and the limits of these programs."""
