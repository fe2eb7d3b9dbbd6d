"""MJCF as bare lxml trees: units and operations on them."""
