"""Ways through a recipe and the models: where a name is from, who uses it, what is where."""
