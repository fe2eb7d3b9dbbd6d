"""Exact numbers: rotations, and draws that are the same bits on every machine."""
