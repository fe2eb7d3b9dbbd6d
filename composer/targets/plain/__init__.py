"""The plainest MJCF that MuJoCo compiles to the same model: what readers of their own understand."""
