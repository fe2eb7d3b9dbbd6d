"""Compiled models: MuJoCo's own `MjModel` and `MjData`, and views on them for the elements of a tree.

MuJoCo is imported when a model is compiled, not before.
"""
