"""A model in the browser, in pictures and in films."""
