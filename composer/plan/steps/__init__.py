"""What a recipe writes, as steps: one file for each type, and the table of them all."""
