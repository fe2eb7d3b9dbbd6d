"""Apply the fixes of diagnostics in memory, until nothing is left to fix."""
