"""Bundles in a program: the model, its manifest, and an index of names. Start with `composer.load`."""
