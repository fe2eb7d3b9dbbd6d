"""Modules that every package may use: diagnostics, files and access to them, child processes, exact numbers."""

__version__ = "0.1.0"
"""The version of mjcompose, the one place it is written."""
