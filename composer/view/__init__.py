"""A model in the browser: as one self-contained page, or live."""
