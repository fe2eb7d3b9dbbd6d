"""What the verbs of `edit` do, one file each."""
