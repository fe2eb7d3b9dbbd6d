"""Rules of the family `ranges`."""
