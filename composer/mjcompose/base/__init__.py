"""What everything may use: diagnostics, files and who may read them, child processes, exact numbers."""
