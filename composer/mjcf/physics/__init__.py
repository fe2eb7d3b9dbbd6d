"""Compiled models: MuJoCo's own `MjModel` and `MjData`, and views on their arrays for the elements of a tree.

MuJoCo is imported only when a model is compiled.
"""
