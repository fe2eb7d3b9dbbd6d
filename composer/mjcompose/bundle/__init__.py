"""Bundles: a finished model as `{path: bytes}` with a manifest, and the forms that it is written in."""
