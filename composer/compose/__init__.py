"""Carry out a plan. Each kind of step has its own file."""
