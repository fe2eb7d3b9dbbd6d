"""How keys of the language are declared: models, rules, kinds of values, and everything derived from them."""
