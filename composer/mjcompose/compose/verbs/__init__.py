"""The verbs of `edit`, one file each."""
