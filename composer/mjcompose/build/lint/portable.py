"""Rules of the family `portable`."""
