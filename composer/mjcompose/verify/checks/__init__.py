"""The execution of each kind of check, in a file of its own."""
