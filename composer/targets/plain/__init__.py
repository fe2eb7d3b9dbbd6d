"""The plainest MJCF that MuJoCo compiles to the same model, for programs with parsers of their own."""
