"""The declarations of keys of the language: models, rules, kinds of values, and everything derived from them."""
