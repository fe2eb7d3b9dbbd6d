"""The kinds of checks on a compiled model, one file each. They run in MuJoCo's child process."""
