"""The language server: what editors ask."""
