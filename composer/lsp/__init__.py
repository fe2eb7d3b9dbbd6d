"""A language server: completion, hover, navigation and actions for recipes that are being edited."""
