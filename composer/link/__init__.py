"""The linker: units that each mean something alone become one flat model. See `link.py`."""
