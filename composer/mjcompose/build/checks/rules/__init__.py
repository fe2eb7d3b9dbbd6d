"""The rules of the check `lint`, one file each: what a rule can be told, and how it is checked."""
