"""Migrate models from one version of MuJoCo to another."""
