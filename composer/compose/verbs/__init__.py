"""What carries out the verbs of `edit`: one file for each, and the table of them all."""
