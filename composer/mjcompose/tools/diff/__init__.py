"""The differences between two models in physics terms, and the lines that cause them."""
