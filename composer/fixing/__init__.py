"""Carry out the fixes of diagnostics: in memory, until nothing is left that can be fixed."""
