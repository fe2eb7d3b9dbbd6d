"""Rules of the family `physics`."""
