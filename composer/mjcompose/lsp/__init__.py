"""The language server, which answers editors."""
