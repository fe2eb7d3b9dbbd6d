"""A language server: what is known of recipes and of the inside of the models, while they are being written."""
