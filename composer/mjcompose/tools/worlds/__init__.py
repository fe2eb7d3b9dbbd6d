"""Bundles in a program, and many models as one."""
