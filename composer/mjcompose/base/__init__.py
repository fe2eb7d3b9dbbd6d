"""Modules that every package may use: diagnostics, files and who may read them, child processes, exact numbers."""
