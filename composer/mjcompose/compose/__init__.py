"""Carrying out a plan: sources become units, and the recipe's steps act on the result."""
