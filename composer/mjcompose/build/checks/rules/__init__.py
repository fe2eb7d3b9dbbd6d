"""The rules of the check `lint`, one file each: the settings of a rule, and how it is checked."""
