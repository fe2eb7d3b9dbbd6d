"""A model in the browser: as one page that stands alone, or live."""
