"""Fit numbers of a recipe's model to recordings of a robot, and write them as a file of measurements.

`identify` is the tool. The other modules but `model` and `file` run in MuJoCo's process, where recordings are read too:
they may come from anyone.
"""
