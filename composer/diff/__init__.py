"""Differences between two models, in a roboticist's words, each with the line that causes it."""
