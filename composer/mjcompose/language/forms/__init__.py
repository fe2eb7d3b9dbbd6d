"""What declares the keys of the language: models, rules, kinds of values, and what is derived from them."""
