"""The linter: rules for MuJoCo models, one file a family."""
