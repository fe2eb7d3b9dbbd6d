"""MuJoCo compiles the result; each part is what it is alone."""
