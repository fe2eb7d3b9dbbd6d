"""The linker joins units, each a model of its own, into one flat model. See `link.py`."""
