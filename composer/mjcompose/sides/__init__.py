"""A path as a model: a recipe, an MJCF file or a bundle, of the work tree or of a git revision."""
