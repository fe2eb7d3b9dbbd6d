"""Targets: models as other programs read them, for `build --target NAME`."""
