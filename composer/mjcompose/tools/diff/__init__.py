"""What differs between two models, in physics terms, and which line is the reason."""
