"""A compiled model as data for a browser. Runs in the engine's child process."""
