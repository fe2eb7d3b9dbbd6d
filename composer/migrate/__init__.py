"""Models from one version of MuJoCo to another: what changed between them, and whether the result is the same model."""
