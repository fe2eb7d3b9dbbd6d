"""Bundles in a program: the model, its manifest, and where everything is by name. `composer.load` is the way in."""
