"""The form of each check, in a file of its own: what you may write, and what its words mean.

`mjcompose.homes` names the modules that carry checks out.
"""
