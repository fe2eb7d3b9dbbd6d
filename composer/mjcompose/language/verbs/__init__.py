"""The form of each verb of `edit`, in a file of its own: what you may write, and how a plan says it in words.

The effect of a verb is a function of the same name in `compose/verbs`.
"""
