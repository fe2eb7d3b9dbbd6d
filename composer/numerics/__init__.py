"""Exact numbers: rotations, and random draws with the same bits on every machine."""
