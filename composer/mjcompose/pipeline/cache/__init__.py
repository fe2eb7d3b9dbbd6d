"""Models that were built before, and runs over many cells."""
