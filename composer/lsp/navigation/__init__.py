"""Navigation through recipes and models: definitions, references, symbols and renaming."""
