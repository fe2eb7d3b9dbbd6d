"""Carrying out a plan: one file a kind of step."""
