"""The linter: rules for MuJoCo models, one file per family."""
