"""A compiled model as data that a browser draws. Runs in the engine's child process."""
