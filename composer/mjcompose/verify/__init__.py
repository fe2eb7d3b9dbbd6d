"""Compile the result in MuJoCo, and compare each part with its source."""
