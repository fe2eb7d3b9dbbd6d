"""A plan is carried out: sources become units, and the recipe's steps act on the result."""
