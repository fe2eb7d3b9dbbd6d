"""What the verbs of `edit` accept, one file each."""
